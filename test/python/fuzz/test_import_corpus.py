"""The import's fuzz target, without fuzzing: the kinds of input that it draws, and those that it has found."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

import pytest
import yaml

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario import load_floor_plan

TARGET = runpy.run_path(str(Path(__file__).parents[2] / "fuzz" / "import_fuzz.py"))
HUGE_IMAGE = b"P5\n100000 100000\n255\n" + bytes(10)
WIDE_IMAGE = b"P5\n100000 3\n255\n" + b"\xfe" * 300_000


@pytest.mark.slow
def test_any_plan_and_map_is_used_or_rejected_in_one_line(tmp_path: Path) -> None:
    TARGET["fuzz"](tmp_path, number=1, examples=60)


@pytest.mark.slow
def test_any_building_is_used_or_rejected_in_one_line(tmp_path: Path) -> None:
    TARGET["fuzz_buildings"](tmp_path, number=1, examples=60)


def test_target_notices_an_error_that_is_none_of_ours(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(path: Path) -> None:
        raise KeyError(path)

    monkeypatch.setattr("robotteamsim.scenario.load_floor_plan", broken)
    with pytest.raises(KeyError):
        TARGET["check_bytes"](tmp_path, TARGET["MAP"], TARGET["ROOM_IMAGE"])


def test_key_that_looks_like_the_tag_of_a_union_is_an_unknown_key(tmp_path: Path) -> None:
    path = tmp_path / "plan.yaml"
    path.write_bytes(b"<" + TARGET["PLAN"])
    with pytest.raises(ScenarioError) as raised:
        load_floor_plan(path)
    assert str(raised.value) == f"{path}: <name: unknown key; did you mean 'name'?"


@pytest.mark.parametrize(
    ("keys", "image", "message"),
    [
        ({"image": "x" * 300}, b"", "image: there is no file '" + "x" * 56 + "..."),
        ({"image": "a\x00b"}, b"", "image: there is no file 'a\\x00b'"),
        ({"resolution": 1e-300}, TARGET["ROOM_IMAGE"], "resolution: 1.0e-300 is below 0.001"),
        ({"resolution": 1e-6}, TARGET["ROOM_IMAGE"], "resolution: 1.0e-06 is below 0.001"),
        (
            {"origin": [1e300, 0, 0]},
            TARGET["ROOM_IMAGE"],
            "image: bounds.max: x 1e+300 is not above min, 1e+300",
        ),
        ({"origin": [0, -2e6, 0]}, TARGET["ROOM_IMAGE"], "image: bounds.min: y -2e+06 is more than 999 km from 0"),
        ({}, HUGE_IMAGE, "image: 'map.png' has more than 25 million pixels"),
        ({}, WIDE_IMAGE, "image: bounds.max: x 9999 is more than 1000 m from min, -1"),
    ],
)
def test_map_that_fuzzing_has_found_is_rejected_with_its_exact_message(
    tmp_path: Path, keys: dict[str, Any], image: bytes, message: str
) -> None:
    (tmp_path / "map.png").write_bytes(image)
    path = tmp_path / "map.yaml"
    path.write_text(yaml.safe_dump(yaml.safe_load(TARGET["MAP"]) | keys), encoding="utf-8")
    with pytest.raises(ScenarioError) as raised:
        load_floor_plan(path)
    assert str(raised.value) == f"{path}: {message}"
