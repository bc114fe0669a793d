"""Levels of Open-RMF's buildings: places, openings and materials as its own tools have them; mistakes."""

from __future__ import annotations

import cmath
import itertools
import math
import re
from pathlib import Path

import numpy as np
import pytest
import shapely
import yaml
from rmf_house import PLAIN, building_of_three, level, metres, read, wall_of

from robotteamsim.cli import main
from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.plan import solids


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


@pytest.mark.parametrize("kind", ["hinged", "sliding", "double_hinged", "double_sliding"])
def test_leaves_are_3_cm_thick_and_2_2_m_high_and_two_halves_without_a_ratio(tmp_path, kind):
    doors = [[2, 3, {"name": [1, "gate"], "type": [1, kind]}]]
    found = read(tmp_path, {"levels": {"L1": level(doors=doors)}}).plan.doors
    assert {(door.thickness_m, door.height_m) for door in found} == {(0.03, 2.2)}
    ends = [(door.start, door.end) for door in found]
    halves = [((10.0, -2.0), (10.0, -2.5)), ((10.0, -3.0), (10.0, -2.5))]
    assert ends == (halves if kind.startswith("double") else [((10.0, -2.0), (10.0, -3.0))])


def test_gap_without_a_door_stays_open(tmp_path):
    found = read(tmp_path, {"levels": {"L1": level(doors=[])}})
    built = shapely.union_all([solid.polygon for solid in solids(found.plan)])
    opening = shapely.LineString([(10.0, 0.0), (10.0, -5.0)]).difference(built)
    assert (found.plan.doors, opening.length) == ((), pytest.approx(0.9))  # walls are longer at both ends
    assert "there is no door" in found.notes
    (note,) = [note for note in found.notes if note.startswith("the outer wall is open at ")]
    x, y = map(float, re.findall(r"-?\d+\.?\d*", note))
    assert (x, y) == pytest.approx((10.0, -2.5), abs=0.2)


def test_walls_that_enclose_nothing_are_named(tmp_path):
    """Without the north wall, of 10 m."""
    open_room = level(walls=level()["walls"][1:])
    line = "the walls enclose no floor: the outer wall is open on more than 2.5 m"
    assert line in read(tmp_path, {"levels": {"L1": open_room}}).notes
    assert not any("outer wall" in note for note in read(tmp_path, {"levels": {"L1": level()}}).notes)


def test_parameter_is_a_code_and_a_value_and_other_keys_mean_nothing(tmp_path):
    walls = [[a, b, {"alpha": [2, 1], "texture_name": [1, "glass"]}] for a, b, _ in level()["walls"]]
    more = {"flattened_x_offset": 77.0, "floors": [{"parameters": {}, "vertices": [0, 1, 4, 5]}]}
    measured = [[0, 1, {"distance": [2, 20]}]]
    plan = read(tmp_path, {"levels": {"L1": level(walls=walls, measurements=measured, **more)}}).plan
    assert plan.walls[0].end == (20.05, 0.0)
    assert {wall.material for wall in plan.walls} == {None}


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


def test_fiducials_that_disagree_are_averaged_over_all_pairs(tmp_path):
    """In the second level, turns of 170, -170 and 180 degrees, and lengths of 100, 100 and 196.96 pixels for 100, 100
    and 200: the circular mean of the turns is 180 degrees, where that of the numbers is 60.
    """
    slope = math.radians(10.0)
    a, b, c = (0.0, 0.0), (-100.0 * math.cos(slope), -100.0 * math.sin(slope)), (-200.0 * math.cos(slope), 0.0)
    first = level(fiducials=[[100.0 * i, 0, name] for i, name in enumerate("abc")], measurements=[[0, 1, metres(5.0)]])
    second = level(fiducials=[[*place, name] for place, name in zip((a, b, c), "abc", strict=True)], measurements=[])
    plan = read(tmp_path, {"levels": {"L1": first, "L2": second}}, level="L2").plan
    ratio = (1.0 + 1.0 + 1.0 / math.cos(slope)) / 3.0
    # In pixels, y downwards, the mean of b and c turned and scaled is subtracted from that of 100 and 200 pixels.
    shift_x = 100.0 + ratio * (b[0] + c[0]) / 3.0
    shift_y = ratio * (b[1] + c[1]) / 3.0
    x, y = (0.01 * (shift - ratio * at) for shift, at in ((shift_x, 500.0), (shift_y, 100.0)))
    (wall,) = [wall for wall in plan.walls if wall.name == "wall_2"]  # from the vertex [500, 0] to [500, 100]
    assert wall.end == pytest.approx((x, -y), abs=1e-6)


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
        ([[0, float("nan"), "none"]], "'none' is at [0, nan]; expected pixels"),
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


@pytest.mark.parametrize(
    ("building", "line"),
    [
        ({"levels": {}}, "levels: none"),
        ({"levels": {"L1": level(walls=[])}}, "has no walls, so there is no building to import"),
        (
            {"levels": {"L1": level(walls=[])}, "coordinate_system": "wgs84"},
            "has no walls, so there is no building to import",
        ),
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
            "levels.L1: Expected `int`, got `str` - at `$.walls[0][1]`",
        ),
        (
            {"levels": {"L1": level(), "L2": level(elevation=float("inf"))}},
            "levels.L2.elevation: inf; expected a finite number",
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
