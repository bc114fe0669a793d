"""What is exported to Stage and imported again is equal, for all shipped plans and scenarios."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from robotteamsim import scenario as scenarios
from robotteamsim.scenario import FloorPlan
from robotteamsim.setup import resolve
from robotteamsim.stage import export_world, import_world

PLAN = """\
name: house
bounds: {min: [-1, -2], max: [9, 7.5]}
walls:
  - {name: south, from: [0, 0], to: [8, 0.25], thickness_m: 0.15, height_m: 2.4}
  - {name: thick, from: [0, 3], to: [0, 4], thickness_m: 0.8}
  - {name: left, from: [0, 2], to: [3, 2]}
  - {name: right, from: [4, 2], to: [8, 2]}
blocks:
  - {name: column, kind: pillar, polygon: [[5, 4], [6, 4], [6, 5], [5.5, 4.5], [5, 5]], height_m: 1.5}
doors:
  - {name: gate, from: [3, 2], to: [4, 2], kind: fireproof, closed: true}
"""


def _differences(one: Any, other: Any, place: str = "") -> Iterator[tuple[str, Any, Any]]:
    """Yield what differs by more than 1e-8, lists item by item."""
    if isinstance(one, dict) and isinstance(other, dict):
        for key in sorted({*one, *other}):
            yield from _differences(one.get(key), other.get(key), f"{place}.{key}")
    elif isinstance(one, list | tuple) and isinstance(other, list | tuple) and len(one) == len(other):
        for i, pair in enumerate(zip(one, other, strict=True)):
            yield from _differences(*pair, f"{place}.{i}")
    elif not (isinstance(one, float) and isinstance(other, float) and abs(one - other) < 1e-8) and one != other:
        yield place, one, other


def _plan(plan: FloorPlan) -> dict[str, Any]:
    """Return the keys of a plan that Stage has."""
    data = plan.model_dump(exclude={"bays", "levels", "materials", "openings", "passages"})
    for key, lost in (("walls", ["material"]), ("blocks", ["material", "thickness_m"])):
        data[key] = [{name: part for name, part in item.items() if name not in lost} for item in data[key]]
    lost = ["motion", "time_s", "angle_rad"]
    data["doors"] = [{name: part for name, part in door.items() if name not in lost} for door in data["doors"]]
    return data


def _robot(robot: Any) -> dict[str, Any]:
    """Return the keys of a robot that Stage has: directions within a turn, corners in any order."""
    data = robot.model_dump(exclude={"footprint_m", "cmd_vel_hold_s"})
    *place, yaw_rad = data["start_pose"]
    data["start_pose"] = [*place, math.cos(yaw_rad), math.sin(yaw_rad)]
    data["corners"] = sorted(robot.corners_m)
    data["sensors"] = [sensor for sensor in data["sensors"] if sensor["kind"] in ("laser", "sonar")]
    for sensor in (data["laser"], *data["sensors"]):
        yaw = sensor.get("yaw_rad", 0.0)
        for key in {"angle_min_rad", "angle_max_rad", "yaw_rad"} & sensor.keys():
            angle = sensor[key] if key == "yaw_rad" else sensor[key] + yaw
            sensor[key] = [math.cos(angle), math.sin(angle)]
    data["odometry"] |= {"alpha2": 0.0, "alpha4": 0.0}
    data["drive"].pop("max_steering_rate_radps", None)
    if robot.footprint_m:
        data.pop("radius_m")
    return data


def _imported(tmp_path: Path, text: str):
    path = tmp_path / "w.world"
    path.write_text(text, encoding="utf-8")
    return import_world(path)


@pytest.mark.parametrize("name", scenarios.map_names())
def test_shipped_plan_comes_back(tmp_path, name):
    plan = scenarios.load_floor_plan(name)
    found = _imported(tmp_path, export_world(plan).text)
    assert list(_differences(_plan(plan), _plan(found.plan))) == []


@pytest.mark.parametrize("name", scenarios.scenario_names())
def test_shipped_scenario_comes_back(tmp_path, name):
    setup = resolve(scenarios.load(name))
    robots = setup.robots[: setup.scenario.num_robots]
    export = export_world(setup.plan, setup.scenario, robots)
    found = _imported(tmp_path, export.text)
    assert list(_differences(_plan(setup.plan), _plan(found.plan))) == []
    present = [_robot(robot) for robot in robots if robot.present]
    if found.scenario is None:
        assert not present
        return
    again = [_robot(robot) for robot in resolve(found.scenario).robots]
    assert list(_differences(present, again)) == []
    assert (found.scenario.name, found.scenario.run.step_s) == (setup.scenario.name, setup.scenario.run.step_s)
    assert found.scenario.mission.time_limit_s == setup.scenario.mission.time_limit_s


def test_plan_with_each_element_comes_back_exactly(tmp_path):
    (tmp_path / "plan.yaml").write_text(PLAN)
    plan = scenarios.load_floor_plan(tmp_path / "plan.yaml")
    export = export_world(plan)
    assert _imported(tmp_path, export.text).plan == plan
    assert export.notes == ()


def test_open_door_comes_back_and_one_without_a_gap_is_a_block(tmp_path):
    (tmp_path / "plan.yaml").write_text(PLAN.replace("closed: true", "closed: false"))
    plan = scenarios.load_floor_plan(tmp_path / "plan.yaml")
    assert _imported(tmp_path, export_world(plan).text).plan == plan
    lone = 'define door model( )\nmodel( size [9 9 1] boundary 1 noblocks 1 ) door( name "x" size [1 0.1 2] )'
    found = _imported(tmp_path, lone)
    assert ([block.name for block in found.plan.blocks], found.plan.doors) == (["x"], ())


def test_export_names_what_stage_lacks(tmp_path):
    setup = resolve(scenarios.load("warehouse_push"))
    notes = export_world(setup.plan, setup.scenario, setup.robots).notes
    assert notes[0] == "not in Stage: objects, areas, victims, sensors of kind gps"
    assert any("steering angle in Stage" in note for note in notes)
