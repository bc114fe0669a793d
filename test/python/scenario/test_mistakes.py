"""Any value in any place of a scenario loads or is rejected in one line."""

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
    """The room with every key."""
    path = tmp_path_factory.mktemp("room") / "room.yaml"
    path.write_text(write(ROOM), encoding="utf-8")
    return parse(dump(load(path)), "dump")


def _places(data: Any, prefix: str = "") -> list[tuple[str, Any, Any]]:
    """Return (dotted key, container, key) of every value in nested mappings and lists."""
    keys = list(data) if isinstance(data, dict) else range(len(data)) if isinstance(data, list) else []
    return [place for key in keys for place in ((f"{prefix}{key}", data, key), *_places(data[key], f"{prefix}{key}."))]


def _errors(path: Path, overrides: Sequence[str] = ()) -> list[str]:
    """Return what loading reports: nothing, or a line for each mistake."""
    try:
        resolve(load(path, overrides))
    except ScenarioError as error:
        return [str(error), *getattr(error, "__notes__", [])]
    return []


@settings(max_examples=100, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(choice=st.data(), junk=JUNK)
def test_any_value_in_any_place_loads_or_is_rejected_in_one_line(
    full_data: Any, tmp_path: Path, choice: st.DataObject, junk: Any
) -> None:
    data, path = copy.deepcopy(full_data), tmp_path / "mistake.yaml"
    dotted, container, key = choice.draw(st.sampled_from(_places(data)))
    path.write_text(write(data), encoding="utf-8")
    assert all("\n" not in line for line in _errors(path, [f"{dotted}={json.dumps(junk)}"]))
    container[key] = junk
    path.write_text(write(data), encoding="utf-8")
    for line in _errors(path):
        assert line.startswith(f"{path}: ")
        assert "\n" not in line
        assert len(line) < 400
