"""Levels of Open-RMF's buildings: places, openings and materials as its own tools have them; mistakes."""

from __future__ import annotations

import cmath
import itertools
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
import yaml

from robotteamsim.cli import main
from robotteamsim.errors import ScenarioError
from robotteamsim.formats import Imported
from robotteamsim.formats.open_rmf import OpenRmfImporter
from robotteamsim.scenario.levels import level_at
from robotteamsim.scenario.loading import from_mapping
from robotteamsim.scenario.plan import solids, wall_corners
from robotteamsim.simulation import Simulation

PLAIN = {"alpha": [3, 1.0]}
SCALE_M = 0.02


def metres(distance: float) -> dict[str, Any]:
    return {"distance": [3, distance]}


def level(**more: Any) -> dict[str, Any]:
    """Return a room of 10 x 5 m whose east wall has a gap of 1 m, in pixels of 2 cm, y downwards."""
    vertices = [[0, 0], [500, 0], [500, 100], [500, 150], [500, 250], [0, 250], [0, 100], [250, 100]]
    return {
        "elevation": 0,
        "vertices": [[x, y, 0, ""] for x, y in vertices],
        "walls": [[a, b, PLAIN] for a, b in ((0, 1), (1, 2), (3, 4), (4, 5), (5, 0))] + [[6, 7, {"alpha": [3, 0.5]}]],
        "doors": [[2, 3, {"name": [1, "gate"], "type": [1, "hinged"]}]],
        # Of 10.1 and 9.9 m for the same 500 pixels.
        "measurements": [[0, 1, metres(10.1)], [0, 1, metres(9.9)]],
        **more,
    }


def read(folder: Path, building: dict[str, Any], **options: Any) -> Imported:
    path = folder / "house.building.yaml"
    path.write_text(yaml.safe_dump({"name": "house", **building}))
    return OpenRmfImporter().read(path, **options)


def test_room_has_its_walls_and_the_full_width_of_its_door(tmp_path):
    plan = read(tmp_path, {"levels": {"L1": level()}}).plan
    walls = {wall.name: wall for wall in plan.walls}
    assert [len(plan.walls), len(plan.doors), plan.name] == [6, 1, "house L1"]
    assert (walls["wall_1"].start, walls["wall_1"].end) == ((-0.05, 0.0), (10.05, 0.0))
    assert (walls["wall_2"].start, walls["wall_2"].end) == ((10.0, 0.05), (10.0, -2.0))  # ends at the door
    assert (walls["wall_3"].start, walls["wall_3"].end) == ((10.0, -3.0), (10.0, -5.05))
    assert {(wall.thickness_m, wall.height_m) for wall in plan.walls} == {(0.1, 2.5)}
    (door,) = plan.doors
    assert (door.name, door.start, door.end, door.closed) == ("gate", (10.0, -2.0), (10.0, -3.0), False)
    built = shapely.union_all([solid.polygon for solid in solids(plan) if solid.kind != "door"])
    opening = shapely.LineString([(10.0, 0.0), (10.0, -5.0)]).difference(built)
    assert opening.length == pytest.approx(1.0, abs=1e-9)
    # Corners close.
    assert built.buffer(-0.04).covers(shapely.Point(0.0, 0.0))


def test_transparent_wall_is_of_glass(tmp_path):
    found = read(tmp_path, {"levels": {"L1": level()}})
    assert [wall.name for wall in found.plan.walls if wall.material == "glass"] == ["wall_6"]
    assert [material.name for material in found.plan.materials] == ["glass"]
    assert "1 wall drawn transparent: taken as 6 mm of glass" in found.notes


def test_double_door_is_two_leaves_by_its_ratio(tmp_path):
    doors = [[2, 3, {"name": [1, "gate"], "type": [1, "double_hinged"], "right_left_ratio": [3, 3.0]}]]
    left, right = read(tmp_path, {"levels": {"L1": level(doors=doors)}}).plan.doors
    assert (left.name, left.start, left.end) == ("gate_left", (10.0, -2.0), (10.0, -2.25))
    assert (right.name, right.start, right.end) == ("gate_right", (10.0, -3.0), (10.0, -2.25))


def test_doors_have_names_of_their_own(tmp_path):
    names = ["", "wall_1", "gate_left", "gate", "a\x07", "b" * 300, "door_1"]
    doors = [[2, 3, {"name": [1, name], "type": [1, "double_hinged"]}] for name in names]
    found = read(tmp_path, {"levels": {"L1": level(doors=doors)}}).plan.doors
    assert len(found) == 2 * len(names)
    assert [door.name for door in found[::2]] == [
        *("door_1_left", "wall_1_left", "gate_left_left", "gate_left", "door_5_left", "door_6_left", "door_1_7_left")
    ]
    (single,) = read(tmp_path, {"levels": {"L1": level(doors=[[2, 3, {"name": [1, "wall_1"]}]])}}).plan.doors
    assert single.name == "wall_1_1"


def test_door_that_is_in_no_gap_is_left_out_by_its_name(tmp_path):
    found = read(tmp_path, {"levels": {"L1": level(doors=[[0, 1, {"name": [1, "painted"]}], [3, 3, {}]])}})
    assert found.plan.doors == ()
    assert "1 door without a length: left out" in found.notes
    assert any(
        re.fullmatch(r"door painted: the leaf .* lies in wall 'wall_1'; .*; left out", one) for one in found.notes
    )


def test_holes_are_openings_of_their_level(tmp_path):
    own = {"fiducials": [[0, 0, "a"], [500, 0, "b"]]}
    levels = {"L1": level(**own), "L2": level(elevation=3.0, holes=[{"vertices": [0, 1, 5]}], **own)}
    found = read(tmp_path, {"levels": levels})
    (opening,) = found.plan.openings
    corners = [found.plan.levels[1].in_building(corner) for corner in opening.polygon]
    assert corners == [pytest.approx(corner) for corner in ((0.0, 0.0, 3.0), (10.0, 0.0, 3.0), (0.0, -5.0, 3.0))]
    assert "level L2: 1 hole in the floor: robots drive over them" in found.notes


def test_hole_without_area_is_rejected(tmp_path):
    with pytest.raises(ScenarioError, match=r"levels\.L1\.holes\.0: polygon: encloses no area"):
        read(tmp_path, {"levels": {"L1": level(holes=[{"vertices": [0, 1, 0]}])}})


def test_fault_of_another_level_does_not_matter(tmp_path):
    levels = {"L1": level(), "L2": {"vertices": []}}
    assert read(tmp_path, {"levels": levels}).plan.name == "house L1"


@pytest.mark.parametrize(("turn_rad", "size"), [(0.0, 1.0), (0.7, 1.3), (-2.9, 0.4)])
def test_other_level_lies_by_its_fiducials_and_not_by_its_own_measurement(tmp_path, turn_rad, size):
    """The second level is the first one, turned and scaled in its drawing, with a wrong measurement of its own."""
    first = level(fiducials=[[0, 0, "a"], [500, 0, "b"], [500, 250, "c"]])
    factor, shift = size * cmath.exp(1j * turn_rad), complex(70.0, -30.0)

    def drawn(x: float, y: float) -> list[float]:
        z = factor * complex(x, -y) + shift
        return [z.real, -z.imag]

    second = level(
        vertices=[[*drawn(x, y), 0, ""] for x, y, *_ in first["vertices"]],
        fiducials=[[*drawn(x, y), name] for x, y, name in first["fiducials"]],
        measurements=[[0, 1, metres(77.0)]],
    )
    levels = {"levels": {"L1": first, "L2": second}}
    expected, found = (read(tmp_path, levels, level=name).plan for name in ("L1", "L2"))
    for wall, other in zip(expected.walls, found.walls, strict=True):
        np.testing.assert_allclose([wall.start, wall.end], [other.start, other.end], atol=2e-6)


def test_level_without_shared_fiducials_lies_by_its_own_measurement_and_says_so(tmp_path):
    second = level(measurements=[[0, 1, metres(20.0)]], fiducials=[[0, 0, "a"]])
    levels = {"levels": {"L1": level(fiducials=[[0, 0, "a"]]), "L2": second}}
    lift = {"x": 1, "y": 2, "yaw": 0.0, "width": 1.0, "depth": 1.0, "level_doors": {"L2": ["d"]}}
    found = read(tmp_path, {**levels, "lifts": {"a": {**lift, "reference_floor_name": "L2"}}}, level="L2")
    assert found.plan.walls[0].end == (20.05, 0.0)
    said = [note for note in found.notes if note.startswith("level L2 shares fewer than two fiducials with L1: ")]
    assert len(said) == 1
    assert "level L1: left out; --level L1 imports it" in found.notes


@pytest.mark.parametrize(
    ("fiducials", "line"),
    [
        ([[0, i, i] for i in range(1001)], "1001 entries; expected at most 1000"),
        ([[0, 1e300, "far"]], "'far' is at [0, 1e+300]; expected pixels"),
    ],
)
def test_fiducials_that_cannot_be_are_one_line(tmp_path, fiducials, line):
    levels = {"L1": level(), "L2": level(fiducials=fiducials)}
    with pytest.raises(ScenarioError, match=re.escape(f"house.building.yaml: levels.L2.fiducials: {line}")):
        read(tmp_path, {"levels": levels}, level="L2")


def test_reference_level_is_named_or_the_first_and_lies_first(tmp_path):
    """The other level, without fiducials, lies by its own measurement."""
    levels = {"L1": level(), "L2": level(measurements=[[0, 1, metres(20.0)]], elevation=3.0)}
    for reference, names, length_m in (({}, ["L1", "L2"], 10.0), ({"reference_level_name": "L2"}, ["L2", "L1"], 20.0)):
        plan = read(tmp_path, {"levels": levels, **reference}).plan
        assert [one.name for one in plan.levels] == names
        assert (plan.levels[0].origin, plan.walls[0].end) == ((0.0, 0.0), (length_m + 0.05, 0.0))


def building_of_three(**lift: Any) -> dict[str, Any]:
    """Return a building of three rooms, 4 m above one another, with lift "a" from the first to the third."""
    levels = {f"L{i}": level(elevation=4.0 * i) for i in (1, 2, 3)}
    door = {"x": 0.0, "y": 0.56, "width": 0.8}
    place = {"reference_floor_name": "L1", "x": 100, "y": 50, "yaw": 0.5, "width": 2.0, "depth": 1.0}
    lifts = {"a": {**place, "doors": {"d": door}, "level_doors": {"L1": ["d"], "L3": ["d"]}, **lift}}
    return {"levels": levels, "lifts": lifts}


def test_levels_lie_side_by_side_each_as_if_it_were_alone(tmp_path):
    building = building_of_three()
    plan = read(tmp_path, building).plan
    assert [(one.name, one.elevation_m) for one in plan.levels] == [("L1", 4.0), ("L2", 8.0), ("L3", 12.0)]
    for one, other in itertools.pairwise(plan.levels):
        assert other.bounds.min[0] - one.bounds.max[0] == pytest.approx(10.0)
    for one in plan.levels:
        alone = read(tmp_path, building, level=one.name).plan
        expected = shapely.affinity.translate(shapely.union_all([wall_of(wall) for wall in alone.walls]), *one.origin)
        names = {f"{one.name}_{wall.name}" for wall in alone.walls}
        found = shapely.union_all([wall_of(wall) for wall in plan.walls if wall.name in names])
        assert found.symmetric_difference(expected).area < 1e-5
        assert [door.name for door in plan.doors if door.name.startswith(one.name)] == [f"{one.name}_gate"]


@pytest.mark.parametrize("length_m", [10.0 / 3.0, 7.123456789, 12.000000499])
def test_levels_fit_into_their_plan_at_any_scale(tmp_path, length_m):
    building = building_of_three()
    for one in building["levels"].values():
        one["measurements"] = [[0, 1, metres(length_m)]]
    assert len(read(tmp_path, building).plan.levels) == 3


def wall_of(wall: Any) -> shapely.Polygon:
    return shapely.Polygon(wall_corners(wall))


def test_lift_joins_the_levels_at_which_it_has_doors_of_their_width(tmp_path):
    found = read(tmp_path, building_of_three())
    plan = found.plan
    (lift,) = plan.passages
    assert [level_at(plan.levels, stop).name for stop in lift.stops] == ["L1", "L3"]
    origins = [plan.levels[0].origin, plan.levels[2].origin]
    np.testing.assert_allclose(np.subtract(lift.stops, origins), [[2.0, -1.0]] * 2, atol=1e-6)
    assert [block.name for block in plan.blocks] == ["L2_lift a"]
    assert "level L2: lift a: its shaft is a block, for it has no door here" in found.notes
    shaft = shapely.union_all(
        [wall_of(wall) for wall in plan.walls if "lift a wall" in wall.name and "L1" in wall.name]
    )
    middle = complex(2.0, -1.0)
    gap = [middle + cmath.exp(0.5j) * complex(x, 0.55) for x in (-1.0, 1.0)]
    front = shapely.LineString([(z.real, z.imag) for z in gap])
    cabin = [middle + cmath.exp(0.5j) * complex(x, y) for x, y in ((-1, -0.5), (1, -0.5), (1, 0.5), (-1, 0.5))]
    assert front.intersection(shaft).length == pytest.approx(2.0 - 0.8, abs=1e-5)
    assert shapely.Polygon([(z.real, z.imag) for z in cabin]).buffer(-1e-5).intersection(shaft).is_empty


def test_a_team_searches_all_levels_that_a_lift_joins(tmp_path):
    """The room of L3 is reached by the lift alone; L2, at which it does not stop, is listed."""
    door = {"x": 0.0, "y": 0.81, "width": 1.0}
    building = building_of_three(x=350, width=2.0, depth=1.5, doors={"d": door}, yaw=math.pi)
    found = read(tmp_path, building)
    plan = found.plan
    assert [note for note in found.notes if note.startswith("no door or passage leads from the largest part of L1 to")]
    x, y = plan.levels[2].origin
    keys = {
        "name": "search",
        "plan": plan.model_dump(by_alias=True),
        "robots": {"count": 2, "start_poses": [[6.0, -3.5, 0.0], [8.0, -3.5, 0.0]]},
        "control": {"algorithm": "search"},
        "mission": {"time_limit_s": 300.0, "victims": [{"name": "ann", "position": [x + 8.0, y - 4.0]}]},
    }
    assert Simulation(from_mapping(keys, "search")).run().victims_saved == 1


def test_levels_at_one_height_are_one_line(tmp_path):
    with pytest.raises(ScenarioError, match="levels L1 and L2 are both at 0 m; --level imports one of them"):
        read(tmp_path, {"levels": {"L1": level(), "L2": level()}})


def test_levels_that_have_no_room_side_by_side_are_one_line(tmp_path):
    levels = {f"L{i}": level(measurements=[[0, 1, metres(600.0)]], elevation=i) for i in (1, 2)}
    line = "2 levels side by side are 1212 m wide; expected at most 1000; --level imports one of them"
    with pytest.raises(ScenarioError, match=line):
        read(tmp_path, {"levels": levels})


def test_metres_are_neither_scaled_nor_flipped(tmp_path):
    building = {"levels": {"L1": level(measurements=[])}, "coordinate_system": "cartesian_meters"}
    plan = read(tmp_path, building).plan
    assert (plan.walls[1].start, plan.walls[1].end) == ((500.0, -0.05), (500.0, 100.0))


def test_shaft_of_a_lift_is_a_block_turned_in_the_map(tmp_path):
    place = {"reference_floor_name": "L1", "x": 100, "y": 50, "yaw": 0.5, "width": 2.0, "depth": 1.0}
    served = {"a": ["L1", "L3"], "b": ["L2", "L3"], "c": []}
    lifts = {name: {**place, "level_doors": {one: ["d"] for one in levels}} for name, levels in served.items()}
    levels = {f"L{i}": level(elevation=4.0 * i) for i in (1, 2, 3, 4)}
    building = {"levels": levels, "lifts": lifts}
    shafts = [[block.name for block in read(tmp_path, building, level=name).plan.blocks] for name in levels]
    assert shafts == [["lift a"], ["lift a", "lift b"], ["lift a", "lift b"], []]  # "a" passes L2
    (block,) = read(tmp_path, building, level="L1").plan.blocks
    turned = shapely.affinity.rotate(shapely.box(0.95, -1.55, 3.05, -0.45), 0.5, use_radians=True)
    assert shapely.Polygon(block.polygon).symmetric_difference(turned).area < 1e-4


@pytest.mark.parametrize(
    ("building", "line"),
    [
        ({"levels": {}}, "levels: none"),
        ({"levels": {"L1": level(walls=[])}}, "levels.L1: has no walls, so there is no building to import"),
        ({"levels": {"L1": level(measurements=[])}}, "levels.L1: has no measurement, so its scale is unknown"),
        (
            {"levels": {"L1": level(measurements=[[0, 1, metres(-1.0)]])}},
            "levels.L1.measurements.0: -1 m for 500 pixels; expected more than 0",
        ),
        (
            {"levels": {"L1": level(walls=[[0, 0, PLAIN]])}},
            "levels.L1: has no walls, so there is no building to import",
        ),
        (
            {"levels": {"L1": level(measurements=[[0, 1, metres(4000.0)]])}},
            "levels.L1: bounds.max: x 4000.5 is more than 1000",
        ),
        (
            {"levels": {"L1": level(measurements=[[0, 1, {"distance": [3, True]}]])}},
            "levels.L1.measurements.0.distance: True",
        ),
        (
            {"levels": {"L1": level(doors=[[2, 3, {"type": [1, "double_sliding"], "right_left_ratio": [3, -3.0]}]])}},
            "levels.L1.doors.0.right_left_ratio: -3; expected more than 0",
        ),
        ({"levels": {"L1": level(measurements=[[0, 1, {}]])}}, "levels.L1.measurements.0.distance: missing; expected"),
        ({"levels": {"L1": level(walls=[[0, 99, PLAIN]])}}, "levels.L1.walls.0: vertex 99; expected 0 to 7"),
        (
            {"levels": {"L1": level(walls=[[0, "x", PLAIN]])}},
            "Expected `int`, got `str` - at `$.levels[...].walls[0][1]`",
        ),
        (
            {"levels": {"L1": level(vertices=[[0, float("nan"), 0, ""]] * 8)}},
            "levels.L1.measurements.0: vertex 0 is at [0, nan]; expected two numbers",
        ),
        (
            {"levels": {"L1": level(measurements=[[0, 1, metres(1e9)]])}},
            "levels.L1.walls.0: vertex 1 is at [1e+09, 0] m; expected at most 100000",
        ),
        (
            {"levels": {"L1": level()}, "coordinate_system": "wgs84"},
            "coordinate_system: 'wgs84'; expected reference_image or cartesian_meters",
        ),
        (
            {"levels": {"L1": level()}, "reference_level_name": "L3"},
            "there is no level 'L3'; expected one of L1",
        ),
    ],
)
def test_mistake_is_one_line_with_its_place(tmp_path, building, line):
    with pytest.raises(ScenarioError, match=f"^{tmp_path}/house.building.yaml: {re.escape(line)}"):
        read(tmp_path, building)


def test_command_imports_a_level_with_a_picture(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    building = {"name": "house", "coordinate_system": "reference_image", "levels": {"L1": level(), "L2": level()}}
    Path("house.yaml").write_text(yaml.safe_dump(building))
    assert main(["plan", "import", "house.yaml", "--level", "L2", "--png", "p.png"]) == 0
    said = capsys.readouterr()
    assert said.out == "plan.yaml: 11 x 6 m, 6 walls, 0 lifts, 1 door\np.png\n"
    assert "robotteamsim: warning: level L1: left out; --level L1 imports it\n" in said.err
    assert Path("p.png").stat().st_size > 1000
    assert main(["plan", "import", "house.yaml", "--level", "L9"]) == 2
    assert "house.yaml: there is no level 'L9'; expected one of L1, L2" in capsys.readouterr().err
    assert main(["plan", "import", "house.yaml", "--metres-per-pixel", "0.1"]) == 2
    assert (
        "house.yaml is a building.yaml of Open-RMF, for which there is no --metres-per-pixel" in capsys.readouterr().err
    )
