"""Stairs, ramps and lifts of IFC files: stops, lengths and holes as they were put in; missions over them."""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from ifc_house import House, box, placed, read

from robotteamsim.formats import Imported
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.loading import from_mapping
from robotteamsim.simulation import Simulation

HOLE = [(2.5, 1.0), (5.0, 1.0), (5.0, 2.0), (2.5, 2.0)]


def two_storeys(house: House, *, with_slab: bool = True) -> None:
    """Add two rooms of 8 x 6 m, 3 m above one another, and a slab with a hole of 2.5 x 1 m between them."""
    for name, floor_m in (("EG", 0.0), ("OG", 3.0)):
        house.storey(name, floor_m)
        walls = house.room(8.0, 6.0, low=floor_m, high=floor_m + 2.7)
    if with_slab:
        house.prism("IfcSlab", [[(0.0, 0.0), (8.0, 0.0), (8.0, 6.0), (0.0, 6.0)], HOLE], 2.7, 3.0)
    house.filling(house.opening(walls[0], 1.0, 0.9, low=3.0, high=5.1))


def place(plan: FloorPlan, index: int) -> np.ndarray:
    """Return a stop of the only passage in the building [m]."""
    (passage,) = plan.passages
    return np.subtract(passage.stops[index], plan.levels[index].origin)


def bodies(plan: FloorPlan, level: str) -> shapely.Geometry:
    """Return what blocks robots of stairs and ramps on a level."""
    blocks = [block for block in plan.blocks if block.name.startswith((f"{level}_stairs", f"{level}_ramp"))]
    return shapely.union_all([shapely.Polygon(block.polygon) for block in blocks])


@pytest.fixture
def ordered(tmp_path: Path) -> Any:
    """Return a reader that puts the lower storey first."""

    def ordered_read(house: House) -> Imported:
        house.filling(house.opening(house.file.by_type("IfcWall")[0], 6.5, 0.9))
        return read(tmp_path, house)

    return ordered_read


@pytest.mark.parametrize(("schema", "unit"), [("IFC2X3", "MILLIMETERS"), ("IFC4", "INCHES"), ("IFC4X3", "METERS")])
@pytest.mark.parametrize(("ifc_class", "inside_out"), [("IfcStair", False), ("IfcStairFlight", True)])
def test_straight_stairs_join_two_storeys(ordered, schema, unit, ifc_class, inside_out):
    """15 risers of 0.2 m, 14 treads of 0.25 m, from x = 1.5 to 5 m, in the middle of y = 1 and 2 m."""
    house = House(schema, unit)
    two_storeys(house)
    whole = house.add("IfcStair", None, placed(0.0, 0.0, 0.0)) if ifc_class == "IfcStairFlight" else None
    house.flight((1.5, 1.5, 0.0), (1.0, 0.0), 14, of=whole, ifc_class=ifc_class, inside_out=inside_out)
    found = ordered(house)
    plan = found.plan
    (stairs,) = plan.passages
    assert (stairs.kind, stairs.takes("robots")) == ("stairs", False)
    np.testing.assert_allclose(place(plan, 0), [1.0, 1.5], atol=1e-4)
    np.testing.assert_allclose(place(plan, 1), [5.5, 1.5], atol=1e-4)
    assert stairs.length_m == pytest.approx(math.hypot(3.5, 3.0), rel=0.01)
    # The step whose top is 2 m above the floor is the tenth.
    assert bodies(plan, "EG").symmetric_difference(shapely.box(1.5, 1.0, 4.0, 2.0)).area < 1e-3
    assert bodies(plan, "OG").is_empty
    (hole,) = plan.openings
    expected = shapely.affinity.translate(shapely.Polygon(HOLE), *plan.levels[1].origin)
    assert shapely.Polygon(hole.polygon).symmetric_difference(expected).area < 1e-3
    assert "stairs are for people; robots take those with `robots: true` in the plan" in found.notes
    assert not any("joins no storeys" in note for note in found.notes)


def test_hole_of_a_slab_may_be_an_opening_element_or_missing(ordered):
    for has_opening in (True, False):
        house = House()
        two_storeys(house, with_slab=False)
        slab = house.wall((0.0, 3.0), (8.0, 3.0), 6.0, low=2.7, ifc_class="IfcSlab")
        if has_opening:
            house.opening(slab, 2.5, 2.5, low=2.6, high=3.1, depth=4.0)
        house.flight((1.5, 1.5, 0.0), (1.0, 0.0), 14)
        plan = ordered(house).plan
        area_m2 = sum(shapely.Polygon(hole.polygon).area for hole in plan.openings)
        assert area_m2 == pytest.approx(2.5 * 1.0 if has_opening else 0.0, abs=1e-3)


def test_stairs_that_turn_begin_and_end_side_by_side(ordered):
    """Two flights of 7 treads of 0.25 m and a landing of 1 m between them, 1.5 m above the floor."""
    house = House()
    two_storeys(house, with_slab=False)
    whole = house.add("IfcStair", None, placed(0.0, 0.0, 0.0))
    house.flight((2.0, 1.5, 0.0), (1.0, 0.0), 7, riser=0.1875, of=whole)
    house.solids("IfcSlab", [box((3.75, 1.0, 1.35), (4.75, 3.2, 1.5))], of=whole)
    house.flight((3.75, 2.7, 1.5), (-1.0, 0.0), 7, riser=0.1875, of=whole)
    plan = ordered(house).plan
    np.testing.assert_allclose(place(plan, 0), [1.5, 1.5], atol=1e-3)
    np.testing.assert_allclose(place(plan, 1), [1.5, 2.7], atol=1e-3)
    to_the_last_step_m, to_the_middle_of_the_landing_m = math.hypot(1.625, 1.4), math.hypot(0.625, 0.6)
    expected_m = 2.0 * (to_the_last_step_m + to_the_middle_of_the_landing_m)
    assert plan.passages[0].length_m == pytest.approx(expected_m, rel=0.03)
    assert bodies(plan, "EG").covers(shapely.box(3.8, 1.1, 4.7, 3.1))


def test_one_stairs_of_three_storeys_stop_at_each(tmp_path):
    house = House()
    for name, floor_m in (("EG", 0.0), ("OG", 3.0), ("DG", 6.0)):
        house.storey(name, floor_m)
        walls = house.room(10.0, 6.0, low=floor_m, high=floor_m + 2.7)
        house.filling(house.opening(walls[0], 1.0, 0.9, low=floor_m, high=floor_m + 2.1))
    whole = house.add("IfcStair", None, placed(0.0, 0.0, 0.0))
    house.flight((1.5, 1.5, 0.0), (1.0, 0.0), 14, of=whole)
    house.solids("IfcSlab", [box((5.0, 1.0, 2.8), (6.0, 3.0, 3.0))], of=whole)
    house.flight((5.0, 2.5, 3.0), (-1.0, 0.0), 14, of=whole)
    plan = read(tmp_path, house).plan
    (stairs,) = plan.passages
    places = np.subtract(stairs.stops, [level.origin for level in plan.levels])
    np.testing.assert_allclose(places, [[1.0, 1.5], [5.5, 2.0], [1.0, 2.5]], atol=1e-3)
    assert stairs.length_m == pytest.approx(math.hypot(3.375, 2.8) + math.hypot(0.625, 0.5, 0.2), rel=0.03)


def test_spiral_stairs_are_as_long_as_their_middle_line(ordered):
    """16 steps of 0.1875 m around a post, three quarters of a turn; the middle of a sector is 0.61 m from it."""
    house = House()
    two_storeys(house, with_slab=False)
    angles = np.linspace(0.0, 1.5 * math.pi, 16)
    steps = []
    for i, (begin, end) in enumerate(itertools.pairwise(angles)):
        ring = [(r * math.cos(a), r * math.sin(a)) for a in (begin, end) for r in (0.15, 0.9)]
        top = 0.1875 * (i + 1)
        steps.append(np.array([(4.0 + x, 3.0 + y, z) for x, y in ring for z in (top - 0.05, top)]))
    house.solids("IfcStair", steps)
    plan = ordered(house).plan
    radius_m = 2.0 / 3.0 * (0.9**3 - 0.15**3) / (0.9**2 - 0.15**2)
    assert plan.passages[0].length_m == pytest.approx(math.hypot(1.5 * math.pi * radius_m, 3.0), rel=0.07)
    assert place(plan, 0) == pytest.approx([4.6, 2.5], abs=0.25)


def ramp(house: House) -> None:
    """Add a ramp of 6 m from x = 1.5 m."""
    ends = [(1.5, 0.0), (7.5, 0.0), (7.5, 3.0)]
    house.solids("IfcRampFlight", [np.array([(x, y, z) for x, z in ends for y in (3.0, 4.0)])])


def test_ramp_joins_two_storeys_and_robots_take_it(ordered):
    house = House()
    two_storeys(house)
    ramp(house)
    found = ordered(house)
    (passage,) = found.plan.passages
    assert (passage.kind, passage.takes("robots")) == ("ramp", True)
    np.testing.assert_allclose(place(found.plan, 0), [1.0, 3.5], atol=0.06)
    assert passage.length_m == pytest.approx(math.hypot(6.0, 3.0), rel=0.01)
    assert not any("robots: true" in note for note in found.notes)


@pytest.mark.parametrize("kind", ["stairs", "lift"])
def test_a_team_searches_both_storeys(ordered, kind):
    house = House()
    two_storeys(house)
    if kind == "stairs":
        house.flight((1.5, 1.5, 0.0), (1.0, 0.0), 14)
    else:
        house.solids("IfcTransportElement", [box((3.0, 3.0, 0.0), (4.5, 4.5, 5.5))]).PredefinedType = "ELEVATOR"
    found = ordered(house)
    assert [passage.kind for passage in found.plan.passages] == [kind]
    is_listed = [note for note in found.notes if note.startswith("no door or passage leads")]
    assert len(is_listed) == (1 if kind == "stairs" else 0)
    plan = found.plan.model_dump(by_alias=True)
    plan["passages"] = [{**passage, "robots": True} for passage in plan["passages"]]
    x, y = found.plan.levels[1].origin
    keys = {
        "name": "search",
        "plan": plan,
        "robots": {"count": 2, "start_poses": [[6.0, 4.0, 0.0], [6.0, 5.0, 0.0]]},
        "control": {"algorithm": "search"},
        "mission": {"time_limit_s": 300.0, "victims": [{"name": "ann", "position": [x + 7.0, y + 5.0]}]},
    }
    assert Simulation(from_mapping(keys, "search")).run().victims_saved == 1


@pytest.mark.parametrize("schema", ["IFC2X3", "IFC4X3"])
def test_lift_stops_in_the_middle_of_its_shaft_where_that_is_free(ordered, schema):
    house = House(schema)
    two_storeys(house)
    house.wall((0.5, 3.7), (7.5, 3.7), low=6.0, high=8.7)
    house.storey("DG", 6.0)
    lift = house.solids("IfcTransportElement", [box((3.0, 3.0, -1.0), (4.5, 4.5, 8.5))])
    setattr(lift, "OperationType" if schema == "IFC2X3" else "PredefinedType", "ELEVATOR")
    found = ordered(house)
    (passage,) = found.plan.passages
    np.testing.assert_allclose(place(found.plan, 0), [3.75, 3.75], atol=1e-4)
    assert (passage.kind, len(passage.stops), passage.name) == ("lift", 2, f"lift_{lift.id()}")
    assert found.plan.openings == ()  # the slab has its hole elsewhere


def test_stairs_that_reach_the_sky_are_left_out(ordered):
    house = House()
    two_storeys(house)
    house.solids("IfcStair", [box((1.0, 1.0, 0.0), (2.0, 2.0, 1e6))])
    (note,) = [note for note in ordered(house).notes if "joins no storeys" in note]
    assert note.endswith("it is 1e+06 m high; expected at most 200")


@pytest.mark.parametrize(
    ("start", "num_treads", "why"),
    [
        ((1.5, 1.5, 1.0), 9, "it begins at 1.20 m, where no floor is"),
        ((1.5, 1.5, 0.0), 9, "it ends at 1.80 m, where no floor is"),
        ((0.15, 1.5, 0.0), 14, "there is no free floor at its end on EG"),
    ],
)
def test_stairs_that_cannot_be_joined_are_named(ordered, start, num_treads, why):
    house = House()
    two_storeys(house)
    stairs = house.flight(start, (1.0, 0.0), num_treads)
    lift = house.solids("IfcTransportElement", [box((5.0, 3.0, 0.0), (6.5, 4.5, 2.3))])
    lift.PredefinedType = "ELEVATOR"
    empty = house.add("IfcStair", None, placed(0.0, 0.0, 0.0))
    found = ordered(house)
    assert (found.plan.passages, found.plan.openings) == ((), ())
    assert [note for note in found.notes if "joins no storeys" in note] == [
        f"#{empty.id()} (IfcStair): joins no storeys; it has no shape that can be read",
        f"#{stairs.id()} (IfcStairFlight): joins no storeys; {why}",
        f"#{lift.id()} (IfcTransportElement): joins no storeys; its shape, from 0.00 to 2.30 m, is free on 1 storey",
    ]
