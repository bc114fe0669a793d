"""Lifts of Open-RMF's buildings: shafts, doors and stops as they were put in; mistakes."""

from __future__ import annotations

import cmath
import math
import re

import numpy as np
import pytest
import shapely
from rmf_house import building_of_three, level, read, wall_of

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.levels import level_at
from robotteamsim.scenario.loading import from_mapping
from robotteamsim.simulation import Simulation


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


def test_shaft_is_cut_out_of_the_floors_between_the_levels_that_the_lift_serves(tmp_path):
    plan = read(tmp_path, building_of_three()).plan
    shaft = shapely.affinity.rotate(shapely.box(0.95, -1.55, 3.05, -0.45), 0.5, use_radians=True)
    on = [level_at(plan.levels, opening.polygon[0]) for opening in plan.openings]
    assert [one.name for one in on] == ["L2", "L3"]
    for opening, one in zip(plan.openings, on, strict=True):
        expected = shapely.affinity.translate(shaft, *one.origin)
        assert shapely.Polygon(opening.polygon).symmetric_difference(expected).area < 1e-4


def test_lift_lies_in_the_drawing_of_its_reference_floor(tmp_path):
    """L2 is the drawing of L1, moved by [30, 20] pixels and half as large; yaw is that in the map."""
    own = [[0, 0, "a"], [500, 0, "b"]]
    levels = {"L1": level(fiducials=own), "L2": level(elevation=3.0, fiducials=[[30, 20, "a"], [280, 20, "b"]])}
    lift = building_of_three(x=80, y=45, reference_floor_name="L2", level_doors={"L1": ["d"], "L2": ["d"]})["lifts"]
    plan = read(tmp_path, {"levels": levels, "lifts": lift}).plan
    (passage,) = plan.passages
    assert passage.stops[0] == pytest.approx((2.0, -1.0))
    (opening,) = plan.openings
    x, y = np.subtract(opening.polygon[0], opening.polygon[1])
    assert math.atan2(y, x) == pytest.approx(0.5, abs=1e-5)


@pytest.mark.parametrize(
    ("keys", "lines"),
    [
        (
            {"level_doors": {"L1": ["d"], "L9": ["d"]}},
            ["lift a: no stop at L9: there is no such level", "lift a: joins no levels: it has 1 stop"],
        ),
        (
            {"level_doors": {"L1": ["d"], "L3": ["x"]}},
            ["lift a: no stop at L3: the lift has no door 'x'", "lift a: joins no levels: it has 1 stop"],
        ),
        (
            {"level_doors": {"L1": ["d"], "L2": ["d"], "roof": ["d"]}},
            ["lift a: no stop at roof: it has no walls"],
        ),
        ({"level_doors": {}}, ["lift a: joins no levels: it has 0 stops"]),
    ],
)
def test_stop_that_cannot_be_is_named(tmp_path, keys, lines):
    building = building_of_three(**keys)
    building["levels"]["roof"] = level(walls=[], elevation=16.0)
    found = read(tmp_path, building)
    assert [note for note in found.notes if note.startswith("lift a: ")] == lines
    assert len(found.plan.passages) == ("it has no walls" in lines[0])
    assert "level roof: has no walls" in found.notes
    assert not any("left out; --level" in note for note in found.notes)


@pytest.mark.parametrize(
    ("keys", "line"),
    [
        ({"x": float("nan")}, "x: nan; expected a finite number"),
        ({"yaw": float("inf")}, "yaw: inf; expected a finite number"),
        ({"depth": 0.0}, "depth: 0; expected a number above 0"),
        ({"doors": {"d": {"x": 0, "y": 0.56, "width": -0.8}}}, "doors.d.width: -0.8; expected a number above 0"),
        ({"doors": {"d": {"x": 0, "y": float("nan"), "width": 0.8}}}, "doors.d.y: nan; expected a finite number"),
        ({"reference_floor_name": "L7"}, "reference_floor_name: there is no level 'L7'; expected one of L1, L2, L3"),
    ],
)
def test_lift_that_is_impossible_is_one_line(tmp_path, keys, line):
    with pytest.raises(ScenarioError, match=f"^{tmp_path}/house.building.yaml: {re.escape(f'lifts.a.{line}')}$"):
        read(tmp_path, building_of_three(**keys))
