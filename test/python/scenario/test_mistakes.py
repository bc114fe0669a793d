"""Whatever a user writes into a scenario, it loads or is refused in one line."""

from __future__ import annotations

import copy
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario import dump, load
from robotteamsim.scenario.yaml_text import parse, write
from robotteamsim.setup import resolve

pytestmark = pytest.mark.slow

ROOM = parse(
    """\
name: room
plan:
  name: room
  bounds: {min: [0, 0], max: [10, 8]}
  walls: [{name: divider, from: [6, 0], to: [6, 5]}]
  blocks: [{name: shelf, polygon: [[1, 6], [3, 6], [3, 7], [1, 7]]}]
  doors: [{name: gate, from: [6, 5], to: [6, 6]}]
  bays: [{from: [8, 2], to: [9, 2], count: 2}]
robots: {count: 2, start: [3, 3, 0], start_poses: [[4, 4, 0]]}
mission:
  areas: [{name: a, center: [2, 2]}]
  victims: [{name: ann, position: [8, 2]}]
""",
    "room",
)

JUNK = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.sampled_from(["", "x", "1e6", "..", "/", "garage"]),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from(["name", "x", "0"]), inner, max_size=2),
    max_leaves=4,
)


@pytest.fixture(scope="module")
def full_data(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The room with every key said."""
    path = tmp_path_factory.mktemp("room") / "room.yaml"
    path.write_text(write(ROOM), encoding="utf-8")
    return parse(dump(load(path)), "dump")


def _places(data: Any) -> list[tuple[Any, Any]]:
    """Return (container, key) of every value in nested mappings and lists."""
    keys = list(data) if isinstance(data, dict) else range(len(data)) if isinstance(data, list) else []
    return [place for key in keys for place in ((data, key), *_places(data[key]))]


def _told(path: Path, overrides: Sequence[str] = ()) -> list[str]:
    """Return what loading tells the user: nothing, or a line for each mistake."""
    try:
        resolve(load(path, overrides))
    except ScenarioError as error:
        return [str(error), *getattr(error, "__notes__", [])]
    return []


@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(choice=st.data(), junk=JUNK)
def test_any_value_in_any_place_loads_or_is_rejected_in_one_line(
    full_data: Any, tmp_path: Path, choice: st.DataObject, junk: Any
) -> None:
    data = copy.deepcopy(full_data)
    container, key = choice.draw(st.sampled_from(_places(data)))
    container[key] = junk
    path = tmp_path / "mistake.yaml"
    path.write_text(write(data), encoding="utf-8")
    for line in _told(path):
        assert line.startswith(f"{path}: ")
        assert "\n" not in line
        assert len(line) < 400


@settings(max_examples=80, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(choice=st.data(), junk=JUNK)
def test_any_override_of_any_key_loads_or_is_rejected_in_one_line(
    full_data: Any, tmp_path: Path, choice: st.DataObject, junk: Any
) -> None:
    path = tmp_path / "room.yaml"
    path.write_text(write(ROOM), encoding="utf-8")
    section = choice.draw(st.sampled_from(sorted(full_data)))
    keys = [section]
    value = full_data[section]
    while isinstance(value, (dict, list)) and value and choice.draw(st.booleans()):
        key = choice.draw(st.sampled_from(sorted(value) if isinstance(value, dict) else list(range(len(value)))))
        keys.append(str(key))
        value = value[key]
    assert all("\n" not in line for line in _told(path, [f"{'.'.join(keys)}={json.dumps(junk)}"]))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("robots: &r [*r]", "robots.0: a list that contains itself is not a section"),
        ("robots: {start: &p [*p, 1, 2]}", "robots.start.0: a list that contains itself is not a number"),
        ("run: {seed: 1" + 80 * "0" + "}", "run.seed: 1" + 56 * "0" + "... is above 9.0072e+15"),
        ("mission: {time_limit_s: 1e999}", "mission.time_limit_s: .inf is not a finite number"),
        ("mission: {time_limit_s: .nan}", "mission.time_limit_s: .nan is not a finite number"),
        ("mission: {areas: [[1, 2]]}", "mission.areas.0: [1, 2] is not a section"),
        ("radio: {materials: {wood: soft}}", "radio.materials.wood: 'soft' is not a number"),
        ("radio: {materials: [wood]}", "radio.materials: [wood] is not a section"),
    ],
)
def test_odd_value_is_rejected_with_its_exact_message(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "odd.yaml"
    section = text.partition(":")[0]
    rest = {key: value for key, value in ROOM.items() if key != section}
    path.write_text(f"{write(rest)}{text}\n", encoding="utf-8")
    with pytest.raises(ScenarioError) as raised:
        load(path)
    assert str(raised.value) == f"{path}: {message}"
