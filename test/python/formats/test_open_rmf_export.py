"""Buildings that came from Open-RMF are exported as they were; others with notes on what the format lacks."""

from __future__ import annotations

import cmath
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from robotteamsim.cli import main

WALL, GLASS = {"alpha": [3, 1.0]}, {"alpha": [3, 0.5]}


def door(name: str, kind: str, **more: Any) -> dict[str, Any]:
    return {"name": [1, name], "type": [1, kind], **more}


# Two rooms with a hinged and a double door, of which one side is turned; two doors that meet at a wall.
CORNERS = [[0, 0], [12, 0], [12.3, 8], [0, 8], [6, 0], [6, 3], [6, 4], [6, 8], [12.1125, 3], [12.1875, 5]]
MEETING = [[2, 8], [3, 8], [4, 8], [3, 6]]
HOUSE = {
    "name": "house",
    "coordinate_system": "cartesian_meters",
    "levels": {
        "L1": {
            "elevation": 0.0,
            "vertices": [[x, y, 0, ""] for x, y in CORNERS + MEETING],
            "walls": [[a, b, WALL] for a, b in ((0, 1), (1, 8), (9, 2), (2, 12), (10, 3), (3, 0), (4, 5), (11, 13))]
            + [[6, 7, GLASS]],
            "doors": [
                [5, 6, door("room", "hinged")],
                [8, 9, door("gate", "double_hinged", right_left_ratio=[3, 3.0])],
                [10, 11, door("west", "hinged")],
                [12, 11, door("east", "hinged")],
            ],
        },
        "L2": {
            "elevation": 4.0,
            "vertices": [[x, y, 0, ""] for x, y in [*CORNERS[:4], [8, 1], [9, 1], [9, 2]]],
            "walls": [[a, b, WALL] for a, b in ((0, 1), (1, 2), (2, 3), (3, 0))],
            "holes": [{"parameters": {}, "vertices": [4, 5, 6]}],
        },
    },
    "lifts": {
        "lift": {
            "x": 3.0,
            "y": 3.0,
            "yaw": 0.4,
            "width": 1.6,
            "depth": 2.2,
            "level_doors": {"L1": ["front"], "L2": ["front", "back"]},
            "doors": {
                "front": {"door_type": 2, "motion_axis_orientation": 0.0, "x": 0.1, "y": 1.1, "width": 0.9},
                "back": {"door_type": 2, "motion_axis_orientation": 0.0, "x": 0.0, "y": -1.1, "width": 1.0},
            },
        }
    },
}


def export(folder: Path, plan: Path) -> dict[str, Any]:
    assert main(["plan", "export-open-rmf", str(plan), "--out", str(folder)]) == 0
    return yaml.safe_load((folder / f"{plan.stem}.building.yaml").read_text())


@pytest.fixture
def again(tmp_path: Path) -> dict[str, Any]:
    """The house, imported and exported."""
    (tmp_path / "house.building.yaml").write_text(yaml.safe_dump(HOUSE))
    plan = tmp_path / "plan.yaml"
    assert main(["plan", "import", str(tmp_path / "house.building.yaml"), "--out", str(plan)]) == 0
    return export(tmp_path, plan)


def edges(building: dict[str, Any], level: str, kind: str) -> list[list[float]]:
    """Return from where to where edges go, sorted."""
    found = building["levels"][level]
    return sorted([*found["vertices"][a][:2], *found["vertices"][b][:2]] for a, b, _ in found.get(kind, []))


@pytest.mark.parametrize("level", ["L1", "L2"])
@pytest.mark.parametrize("kind", ["walls", "doors"])
def test_edges_of_a_building_of_open_rmf_are_as_they_were(again: dict[str, Any], level: str, kind: str) -> None:
    found, expected = edges(again, level, kind), edges(HOUSE, level, kind)
    assert len(found) == len(expected)
    assert np.ravel(found) == pytest.approx(np.ravel(expected), abs=1e-6)


def test_holes_are_as_they_were(again: dict[str, Any]) -> None:
    level = again["levels"]["L2"]
    (hole,) = level["holes"]
    assert [level["vertices"][corner][:2] for corner in hole["vertices"]] == [[8, 1], [9, 1], [9, 2]]


def test_parameters_of_walls_and_doors_are_as_they_were(again: dict[str, Any]) -> None:
    level = again["levels"]["L1"]
    assert [more["alpha"][1] for *_, more in level["walls"]] == [1.0] * 8 + [0.5]
    found = {more["name"][1]: more for *_, more in level["doors"]}
    assert {name: more["type"] for name, more in found.items()} == {
        "room": [1, "hinged"],
        "gate": [1, "double_hinged"],
        "west": [1, "hinged"],
        "east": [1, "hinged"],
    }
    assert found["gate"]["right_left_ratio"][1] == pytest.approx(3.0, abs=1e-5)


def places(lift: dict[str, Any], level: str) -> tuple[list[complex], list[tuple[float, ...]]]:
    """Return the corners of the cabin, and the places and widths of its doors at a level."""
    middle, turn = complex(lift["x"], lift["y"]), cmath.exp(1j * lift["yaw"])
    w, d = 0.5 * lift["width"], 0.5 * lift["depth"]
    corners = [middle + turn * complex(x, y) for x in (-w, w) for y in (-d, d)]
    doors = []
    for name in lift["level_doors"][level]:
        one = lift["doors"][name]
        z = middle + turn * complex(one["x"], one["y"])
        # The sine of twice the angle is that of the door in either direction.
        across = cmath.exp(2j * (lift["yaw"] + one["motion_axis_orientation"]))
        doors.append((round(z.real, 4), round(z.imag, 4), one["width"], round(across.real, 4), round(across.imag, 4)))
    return sorted(corners, key=lambda z: (round(z.real, 4), z.imag)), sorted(doors)


@pytest.mark.parametrize("level", ["L1", "L2"])
def test_lift_has_its_cabin_and_its_doors(again: dict[str, Any], level: str) -> None:
    (corners, doors), (cabin, expected) = (places(one["lifts"]["lift"], level) for one in (again, HOUSE))
    assert corners == pytest.approx(cabin, abs=2e-5)
    assert np.array(doors) == pytest.approx(np.array(expected), abs=2e-4)
    assert again["lifts"]["lift"]["lowest_floor"] == "L1"


OTHER = """
name: other
bounds: {min: [0, 0], max: [60, 10]}
levels:
  - {name: low, bounds: {min: [0, 0], max: [20, 10]}, elevation_m: 0, height_m: 2.8}
  - {name: high, bounds: {min: [40, 0], max: [60, 10]}, origin: [40, 0], elevation_m: 3}
openings: [{name: well, polygon: [[41, 1], [43, 1], [43, 2], [41, 2]]}]
passages:
  - {name: lift, stops: [[2, 2], [42, 4]]}
  - {name: up, stops: [[5, 5], [45, 5]], radius_m: 0.6}
  - {name: steps, kind: stairs, stops: [[8, 8], [48, 8]]}
materials: [{name: brick_wall, layers: [{of: brick, thickness_m: 0.2}]}]
walls:
  - {name: thick, from: [1, 3], to: [9, 3], material: brick_wall}
  - {name: rest, from: [10, 3], to: [14, 3], thickness_m: 0.1, height_m: 2.5}
  - {name: stub, from: [15, 3], to: [15.08, 3], thickness_m: 0.1, height_m: 2.5}
blocks: [{name: core, polygon: [[16, 1], [18, 1], [18, 2]]}]
doors: [{name: d, from: [9, 3], to: [10, 3], closed: true, motion: swing, angle_rad: -1.2}]
"""


def test_what_the_format_lacks_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plan = tmp_path / "other.yaml"
    plan.write_text(OTHER)
    building = export(tmp_path, plan)
    prefix = "robotteamsim: warning: "
    assert [line.removeprefix(prefix) for line in capsys.readouterr().err.splitlines()] == [
        "passage lift: omitted: its stops are not one above another",
        "passage up: a lift without doors, as wide as its stops: no rectangle of walls 0.1 m thick is around its stops",
        "1 wall: up to 0.05 m shorter or longer at an end",
        "1 wall: 0.1 m thick and 2.5 m high, as all are in Open-RMF",
        "materials: omitted, but that walls of glass are transparent",
        "blocks: omitted: 1 block",
        "doors: omitted: which are closed or fireproof",
        "passages: stairs and ramps are omitted: steps",
        "levels: omitted: height_m and floor_material",
    ]
    # Shorter by 0.05 m where no door is, and not the stub.
    assert edges(building, "low", "walls") == [[1.05, 3.0, 9.0, 3.0], [10.0, 3.0, 13.95, 3.0], [15.0, 3.0, 15.08, 3.0]]
    ((_, _, swing),) = building["levels"]["low"]["doors"]
    assert [swing["motion_degrees"], swing["motion_direction"]] == [[3, pytest.approx(68.75494)], [2, 1]]
    high = building["levels"]["high"]
    (hole,) = high["holes"]
    assert [high["vertices"][corner][:2] for corner in hole["vertices"]] == [[1, 1], [3, 1], [3, 2], [1, 2]]
    (floor,) = high["floors"]
    assert [high["vertices"][corner][:2] for corner in floor["vertices"]] == [[0, 0], [20, 0], [20, 10], [0, 10]]
    lift = building["lifts"]["up"]
    assert [lift["x"], lift["y"], lift["width"], lift["level_doors"]] == [5.0, 5.0, 1.2, {}]


def test_plan_without_levels_is_one_level(tmp_path: Path) -> None:
    plan = tmp_path / "hall.yaml"
    plan.write_text("name: hall\nbounds: {min: [0, 0], max: [5, 5]}\nwalls: [{name: w, from: [1, 1], to: [4, 1]}]\n")
    building = export(tmp_path, plan)
    assert edges(building, "L1", "walls") == [[1.05, 1.0, 3.95, 1.0]]
    assert building["lifts"] == {}
