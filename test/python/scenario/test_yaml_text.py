"""YAML as scenarios use it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.yaml_text import parse, read_mapping, shown, write


@pytest.mark.parametrize(
    ("text", "value"),
    [("1e6", 1e6), ("-2.5e-3", -2.5e-3), (".5", 0.5), ("1.", 1.0), ("7", 7), (".inf", math.inf), ("-.inf", -math.inf)],
)
def test_number_is_read_as_one(text: str, value: float) -> None:
    assert parse(text, "x") == value
    assert type(parse(text, "x")) is type(value)


def test_date_is_plain_text() -> None:
    assert parse("2001-01-01", "x") == "2001-01-01"


def test_merged_keys_may_be_replaced() -> None:
    assert parse("base: &base {a: 1, b: 2}\nmine: {<<: *base, b: 3}", "x")["mine"] == {"a": 1, "b": 3}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: 1\nb:\n  c: 1\n  c: 2\n", "x.yaml:4: duplicate key 'c'"),
        ("a: 1\ntrue: 2\n", "x.yaml:2: key true is not text; put it in quotes"),
        ("? [1]\n: 2\n", "x.yaml:1: a key must be plain text"),
        ("a: *b", "x.yaml: found undefined alias 'b'"),
        ("a: 1\n---\nb: 2\n", "x.yaml:2: but found another document"),
        ("a: \x07", "x.yaml: unacceptable character #x0007: special characters are not allowed"),
        pytest.param("[" * 2000, "x.yaml: nested too deeply", id="deep"),
        (
            "a: !!python/object:os.system x",
            "x.yaml: tags such as !!int are not supported",
        ),
        ("a: 1\nb: !!timestamp x\n", "x.yaml:2: tags such as !!int are not supported"),
        ("a: !!map [b]", "x.yaml: tags such as !!int are not supported"),
        ('a: !!int ""', "x.yaml: tags such as !!int are not supported"),
        ('a: !!bool "x"', "x.yaml: tags such as !!int are not supported"),
        ("!x\na: 1", "x.yaml:1: tags such as !!int are not supported"),
        # libyaml accepts these:
        ("a: 1\nb\t: 2\n", "x.yaml:2: found character '\\t' that cannot start any token"),
        ("a: {nam? e: 1}", "x.yaml: expected ',' or '}', but got '?'"),
        (">#", "x.yaml: expected chomping or indentation indicators, but found '#'"),
    ],
)
def test_bad_yaml_is_rejected_with_its_line(text: str, message: str) -> None:
    with pytest.raises(ScenarioError) as raised:
        parse(text, "x.yaml")
    assert str(raised.value) == message


def _bomb(first: str, level: str) -> str:
    """Nine levels, each with nine aliases of the one before: 10^9 values in ten lines."""
    lines = [f"a0: &a0 {first}"]
    lines += [f"a{i}: &a{i} " + level % ", ".join([f"*a{i - 1}"] * 9) for i in range(1, 10)]
    return "\n".join(lines)


@pytest.mark.parametrize("text", [_bomb("[1, 2]", "[%s]"), _bomb("{k: 1}", "{<<: [%s]}")], ids=["lists", "merges"])
def test_aliases_of_aliases_are_rejected_before_they_fill_the_memory(text: str) -> None:
    with pytest.raises(ScenarioError, match=r"^x.yaml:\d+: more than 200000 values, aliases included$"):
        parse(text, "x.yaml")


@pytest.mark.slow
def test_many_values_are_rejected() -> None:
    with pytest.raises(ScenarioError, match=r"^x.yaml: more than 200000 values"):
        parse("[" + "1," * 200_001 + "]", "x.yaml")


def test_equals_sign_is_plain_text() -> None:
    assert parse("a: =", "x") == {"a": "="}


@pytest.mark.parametrize("number", ["9" * 5000, "0x" + "f" * 5000])
def test_number_of_many_digits_is_rejected(number: str) -> None:
    with pytest.raises(ScenarioError, match=r"^x: a number of 500[02] characters; expected at most 100$"):
        parse(number, "x")


def test_large_file_is_rejected_at_once(tmp_path: Path) -> None:
    path = tmp_path / "comments.yaml"
    path.write_text("# nothing\n" * 500_000, encoding="utf-8")
    with pytest.raises(ScenarioError, match=r"^big: larger than 4 MiB; expected a text file$"):
        read_mapping(path, "big", "a scenario")


def test_endless_file_is_rejected_at_once() -> None:
    with pytest.raises(ScenarioError, match=r"^big: not a regular file$"):
        read_mapping(Path("/dev/zero"), "big", "a scenario")


PLAIN = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(st.characters(codec="utf-8"))


@pytest.mark.slow
@given(st.recursive(PLAIN, lambda inner: st.lists(inner) | st.dictionaries(st.text("abc_1.-~:"), inner), max_leaves=12))
def test_written_value_is_read_back(value: Any) -> None:
    assert parse(write({"value": value}), "x") == {"value": value}


@given(st.floats(allow_nan=False))
def test_written_number_is_a_number_to_programs_with_yaml_1_1(value: float) -> None:
    assert yaml.safe_load(write({"value": value})) == {"value": value}


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ("fast", "'fast'"),
        (None, "null"),
        (True, "true"),
        (0.1, "0.1"),
        ([1, 2.5], "[1, 2.5]"),
        ({"a": 1}, "a section"),
        ("x" * 90, "'" + "x" * 56 + "..."),
    ],
)
def test_value_is_shown_on_one_short_line(value: Any, text: str) -> None:
    assert shown(value) == text


@pytest.mark.parametrize("text", [r'name: "\ud800"', r'a: ["b\udfff"]', r'"\ud800": 1'])
def test_half_of_a_surrogate_pair_is_refused(text):
    with pytest.raises(ScenarioError, match="half of a surrogate pair"):
        parse(text, "a.yaml")


@pytest.mark.parametrize("number", ["010", "-017", "1:30", "12:30:45"])
def test_number_of_base_60_or_8_is_refused(number):
    with pytest.raises(
        ScenarioError, match=rf"a.yaml: {number}: base 60 or 8 in YAML 1.1; expected a number in base 10"
    ):
        parse(f"{{seed: {number}}}", "a.yaml")
    assert parse(f"{{seed: '{number}'}}", "a.yaml") == {"seed": number}
