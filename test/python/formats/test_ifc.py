"""Storeys of IFC files: places, openings and heights as they were put in."""

from __future__ import annotations

import math
import re
from pathlib import Path

import ifcopenshell.geom
import numpy as np
import pytest
import shapely
from ifc_house import UNITS, House, api, opening_m, placed, read, solid
from matplotlib.colors import to_hex

from robotteamsim import palette, rng
from robotteamsim.analysis.import_picture import draw_import
from robotteamsim.cli import main
from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.materials import Layer

SOUTH, EAST = ((0.5, 0.0), (5.5, 0.0)), ((6.0, 0.5), (6.0, 3.5))
"""Lines in the middle of walls of a room."""


@pytest.mark.parametrize("schema", ["IFC2X3", "IFC4", "IFC4X3"])
@pytest.mark.parametrize("unit", UNITS)
def test_room_has_the_walls_and_the_door_of_the_file_in_any_unit(tmp_path, schema, unit):
    house = House(schema, unit)
    house.storey("EG", 3.0)
    south, *_ = house.room(low=3.0, high=5.8)
    house.filling(house.opening(south, 1.0, 0.915, low=3.0, high=5.1), operation="SINGLE_SWING_LEFT")
    plan = read(tmp_path, house).plan
    assert [len(plan.walls), len(plan.doors), plan.name] == [5, 1, "house EG"]
    assert {(wall.thickness_m, wall.height_m) for wall in plan.walls} == {(0.2, 2.8)}
    ends = [(wall.start, wall.end) for wall in plan.walls]
    assert {frozenset(one) for one in ends} >= {
        frozenset({(6.0, 0.0), (6.0, 4.0)}),
        frozenset({(0.0, 0.0), (1.0, 0.0)}),
        frozenset({(1.915, 0.0), (6.0, 0.0)}),
    }
    (door,) = plan.doors
    assert (door.start, door.end, door.height_m, door.closed) == ((1.0, 0.0), (1.915, 0.0), 2.1, False)
    assert plan.drawing_offset_m is None


def test_hinge_is_on_the_side_that_the_door_names(tmp_path):
    house = House()
    house.storey("EG", 0.0)
    south, east, north, _ = house.room()
    for wall, operation in ((south, "SINGLE_SWING_RIGHT"), (east, "SLIDING_TO_LEFT"), (north, "DOUBLE_SWING_RIGHT")):
        house.filling(house.opening(wall, 1.0, 1.0), operation=operation)
    assert [(door.start, door.end) for door in read(tmp_path, house).plan.doors] == [
        ((2.0, 0.0), (1.0, 0.0)),
        ((6.0, 1.0), (6.0, 2.0)),
        ((4.0, 4.0), (5.0, 4.0)),
    ]


@pytest.mark.parametrize("operation", ["DOUBLE_DOOR_SINGLE_SWING", "DOUBLE_DOOR_SLIDING"])
@pytest.mark.parametrize("schema", ["IFC2X3", "IFC4"])
def test_double_door_is_two_leaves(tmp_path, operation, schema):
    house = House(schema)
    house.storey("EG", 0.0)
    south, *_ = house.room()
    house.filling(house.opening(south, 1.0, 1.55), operation=operation)
    left, right = read(tmp_path, house).plan.doors
    assert (left.start, left.end, right.start, right.end) == ((1.0, 0.0), (1.775, 0.0), (2.55, 0.0), (1.775, 0.0))
    assert (left.name.removesuffix("_left"), right.name) == (left.name[:-5], left.name[:-5] + "_right")


def test_door_next_to_a_window_in_one_opening_has_its_own_width(tmp_path):
    house = House()
    house.storey("EG", 0.0)
    south, *_ = house.room()
    hole = house.opening(south, 1.0, 2.0)
    house.filling(hole, body=(0.0, 0.9))
    house.filling(hole, "IfcWindow", body=(0.9, 2.0))
    plan = read(tmp_path, house).plan
    assert [(door.start, door.end) for door in plan.doors] == [((1.0, 0.0), (1.9, 0.0))]
    assert opening_m(plan, *SOUTH) == pytest.approx(0.9, abs=1e-5)


def test_door_that_fills_no_opening_opens_what_it_is_in(tmp_path):
    house = House()
    house.storey("EG", 0.0)
    house.room()
    house.wall((1.0, 0.0), (1.9, 0.0), 0.06, high=2.0, ifc_class="IfcDoor")
    plan = read(tmp_path, house).plan
    assert [(door.start, door.end) for door in plan.doors] == [((1.0, 0.0), (1.9, 0.0))]
    assert opening_m(plan, *SOUTH) == pytest.approx(0.9, abs=1e-5)


def test_door_opens_its_wall_also_where_its_opening_is_shallow(tmp_path):
    house = House()
    house.storey("EG", 0.0)
    south, *_ = house.room()
    house.filling(house.opening(south, 1.0, 0.9, depth=0.2))  # of 0.2 m, half is in front of the wall
    plan = read(tmp_path, house).plan
    assert len(plan.doors) == 1
    assert opening_m(plan, *SOUTH) == pytest.approx(0.9, abs=1e-5)


@pytest.mark.parametrize("sill", [0.0, 0.1, 0.3, 0.9])
def test_windows_do_not_open_the_wall_but_are_of_glass(tmp_path, sill):
    house = House()
    house.storey("EG", 0.0)
    south, *_ = house.room()
    house.layers(south, [("Brick", 0.2)], "IfcMaterial")
    house.filling(house.opening(south, 1.0, 2.0, low=sill), "IfcWindow")
    house.filling(house.opening(south, 3.5, 0.9, high=2.1))
    found = read(tmp_path, house)
    assert opening_m(found.plan, *SOUTH) == pytest.approx(0.9, abs=1e-5)
    pieces = [(wall.start, wall.end, wall.material) for wall in found.plan.walls if wall.start[1] == wall.end[1] == 0.0]
    places = [(0.0, 1.0, "Brick"), (1.0, 3.0, "glass"), (3.0, 3.5, "Brick"), (4.4, 6.0, "Brick")]
    assert pieces == [((begin, 0.0), (end, 0.0), material) for begin, end, material in places]
    glass = Layer(of="glass", thickness_m=0.006)
    assert {one.name: one.layers for one in found.plan.materials}["glass"] == (glass,)
    assert "1 window closed with glass of 6 mm" in found.notes


def test_window_that_is_high_or_in_a_block_is_of_the_material_around_it(tmp_path):
    house = House()
    house.storey("EG", 0.0)
    south, *_ = house.room()
    house.filling(house.opening(south, 1.0, 2.0, low=1.6), "IfcWindow")
    bent = house.prism("IfcWall", [[(1.0, 1.0), (3.0, 1.0), (3.0, 3.0), (2.8, 3.0), (2.8, 1.2), (1.0, 1.2)]])
    house.filling(house.opening(bent, 1.2, 0.8, low=0.9), "IfcWindow")
    found = read(tmp_path, house)
    assert (found.plan.materials, len(found.plan.walls), len(found.plan.blocks)) == ((), 4, 1)
    assert "1 window closed, of the material of the wall around it" in found.notes
    assert "there is no door on storey EG" in found.notes


def test_picture_shows_windows_and_the_two_leaves_of_a_door_by_one_name(tmp_path):
    house = House()
    house.storey("EG", 0.0)
    south, east, *_ = house.room()
    house.filling(house.opening(south, 1.0, 2.0, low=0.9), "IfcWindow")
    door = house.filling(house.opening(east, 1.0, 1.55), operation="DOUBLE_DOOR_SINGLE_SWING")
    figure = draw_import(read(tmp_path, house).plan, ())
    (axes,) = figure.axes
    assert [text.get_text() for text in axes.texts] == [str(door.id())]
    assert axes.texts[0].get_position() == pytest.approx((6.0, 1.775))
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["wall", "wall of glass", "door"]
    glass = [one for one in axes.collections if [*map(to_hex, one.get_facecolor())] == [palette.GLASS]]
    assert [one.get_paths()[0].get_extents().bounds for one in glass] == [pytest.approx((1.0, -0.1, 2.0, 0.2))]


@pytest.mark.parametrize(
    ("low", "high", "depth", "free"),
    [
        (0.0, 2.1, 2.0, 1.2),
        (-0.1, 3.0, 2.0, 1.2),
        (0.18, 2.1, 2.0, 0.0),  # has a sill
        (0.0, 0.6, 2.0, 0.0),  # too low to pass
        (0.0, 2.1, 0.3, 0.0),  # reaches 0.15 m into 0.2 m
    ],
)
def test_opening_without_a_filling_is_open_from_the_floor_and_through_the_wall(tmp_path, low, high, depth, free):
    house = House()
    house.storey("EG", 0.0)
    south, *_ = house.room()
    house.opening(south, 1.0, 1.2, low=low, high=high, depth=depth)
    assert opening_m(read(tmp_path, house).plan, *SOUTH) == pytest.approx(free, abs=1e-5)


def test_low_door_and_door_on_a_landing(tmp_path):
    """A door below 2 m opens its wall though there is a lintel; one whose sill is 1.5 m above the floor does not."""
    house = House()
    house.storey("EG", 0.0)
    south, east, *_ = house.room()
    house.filling(house.opening(south, 1.0, 0.9, high=1.95))
    house.filling(house.opening(east, 1.0, 0.9, low=1.5, high=3.0))
    found = read(tmp_path, house)
    assert opening_m(found.plan, *SOUTH) == pytest.approx(0.9, abs=1e-5)
    assert opening_m(found.plan, *EAST) == pytest.approx(0.0, abs=1e-9)
    assert "1 door with a sill not at the floor: closed" in found.notes


def test_walls_block_where_they_are_and_not_where_they_are_listed(tmp_path):
    house = House()
    house.storey("Foundation", -1.0)
    house.wall((0.0, 0.0), (6.0, 0.0), low=-1.0, high=0.0)  # below the floor
    house.storey("Level 1", 0.0)
    south, *_ = house.room(low=0.0, high=2.6)
    house.filling(house.opening(south, 1.0, 0.9))
    house.wall((2.0, 0.0), (2.0, 4.0), low=2.61, high=6.0)  # above heads
    house.storey("Level 2", 3.0)
    house.room(low=3.0, high=5.6)
    house.wall((3.0, 0.0), (3.0, 4.0), low=1.9, high=3.0)  # its lower end is in the way below
    house.wall((4.0, 0.0), (4.0, 4.0), low=0.0, high=2.0, of=house.site)
    house.wall((5.0, 0.0), (5.0, 4.0), low=5.71, high=6.0)
    house.storey("Roof", 6.0)
    found = read(tmp_path, house, level="Level 1")
    assert found.plan.name == "house Level 1"
    upright = {wall.start[0] for wall in found.plan.walls if wall.start[0] == wall.end[0]}
    assert upright == {0.0, 3.0, 4.0, 6.0}
    assert [note for note in found.notes if note.startswith("storey ")] == [
        f"storey {name}: left out; --level '{name}' imports it" for name in ("Foundation", "Level 2", "Roof")
    ]
    above = read(tmp_path, house, level="Level 2").plan
    assert {wall.start[0] for wall in above.walls if wall.start[0] == wall.end[0]} == {0.0, 2.0, 6.0}
    with pytest.raises(ScenarioError, match=r"\(storey Roof\): has no walls between its floor, at 6 m, and 2 m above"):
        read(tmp_path, house, level="Roof")
    levels = read(tmp_path, house)
    assert [(one.name, one.elevation_m) for one in levels.plan.levels] == [("Level 1", 0.0), ("Level 2", 3.0)]
    assert [note for note in levels.notes if note.startswith("storey ")] == [
        "storey Foundation: left out; it has no door, and is less than 2 m high; --level 'Foundation' imports it",
        "storey Roof: left out; it has no walls",
    ]


def test_all_storeys_lie_side_by_side_each_as_if_it_were_alone(tmp_path):
    """The lowest storey with a door lies first, in the coordinates of the file; one at its height is left out."""
    house = House(unit="FEET")
    for name, floor_m in (("Cellar", -3.0), ("Ground", 0.0), ("Garden", 0.0), ("Upper", 3.0)):
        house.storey(name, floor_m)
        walls = house.room(low=floor_m, high=floor_m + 2.8) if name != "Garden" else []
        if name in ("Ground", "Upper"):
            house.layers(walls[0], [("Brick", 0.2 if name == "Upper" else 0.1)], "IfcMaterialLayerSet", "Wall")
            house.filling(house.opening(walls[1], 1.0 + floor_m / 3.0, 0.9, low=floor_m, high=floor_m + 2.1))
    found = read(tmp_path, house)
    plan = found.plan
    assert [(one.name, one.elevation_m) for one in plan.levels] == [("Ground", 0.0), ("Cellar", -3.0), ("Upper", 3.0)]
    assert plan.levels[0].origin == (0.0, 0.0)
    assert [note for note in found.notes if "Garden" in note] == [
        "storey Garden: left out; it is at the height of Ground"
    ]
    layers = {one.name: one.layers for one in plan.materials}
    for one in plan.levels:
        alone = read(tmp_path, house, level=one.name).plan
        x, y = one.origin
        expected = {
            (f"{one.name}_{wall.name}", *np.round([*wall.start, *wall.end], 5).tolist()) for wall in alone.walls
        }
        on = [wall for wall in plan.walls if wall.name.startswith(one.name)]
        places = [np.subtract([*wall.start, *wall.end], [x, y, x, y]).round(5).tolist() for wall in on]
        assert {(wall.name, *place) for wall, place in zip(on, places, strict=True)} == expected
        assert len([door for door in plan.doors if door.name.startswith(one.name)]) == len(alone.doors)
    thick = {layers[wall.material][0].thickness_m for wall in plan.walls if wall.material and "Upper" in wall.name}
    assert thick == {0.2}


def test_storey_that_cannot_be_a_level_is_one_line_with_its_name(tmp_path):
    house = House()
    for name, length_m in (("EG", 10.0), ("OG", 2000.0)):
        floor_m = 3.0 * len(house.storeys)
        storey = house.storey(name, floor_m)
        house.wall((0.0, 0.0), (length_m, 0.0), low=floor_m, high=floor_m + 2.5)
    with pytest.raises(
        ScenarioError, match=rf"house\.ifc: #{storey.id()} \(storey OG\): bounds\.max: x 2000\.5 is more"
    ):
        read(tmp_path, house)


def test_storey_without_elevation_or_placement_lies_at_its_walls(tmp_path):
    for elevation, placement in ((False, True), (True, False), (False, False)):
        house = House()
        house.storey(None, 3.0, elevation=elevation, placement=placement)
        house.room(low=3.0, high=5.6)
        found = read(tmp_path, house)
        assert len(found.plan.walls) == 4
        assert re.fullmatch(r"house #\d+", found.plan.name)


def test_storeys_whose_elevation_is_wrong_lie_at_their_walls(tmp_path):
    house = House()
    house.storey("EG", 0.0).Elevation = 112_000.0  # above the sea, which the placement is not
    house.room()
    found = read(tmp_path, house)
    assert len(found.plan.walls) == 4
    assert any(note.endswith("its floor is taken at 0 m, near that of its walls") for note in found.notes)


def test_storeys_of_one_name_are_told_apart_by_their_ids(tmp_path):
    house = House()
    ids = [house.storey("EG", floor_m).id() for floor_m in (0.0, 3.0)]
    house.room(low=3.0, high=6.0)
    with pytest.raises(ScenarioError, match=f"there is no storey 'EG'; expected one of EG #{ids[0]}, EG #{ids[1]}"):
        read(tmp_path, house, level="EG")


def test_turned_wall_keeps_its_place(tmp_path):
    house = House(unit="FEET")
    house.storey("EG", 0.0)
    wall = house.wall((1.0, 2.0), (4.0, 6.0), 0.3)
    house.filling(house.opening(wall, 2.0, 1.0))
    plan = read(tmp_path, house).plan
    expected = [(1.0, 2.0), (2.2, 3.6), (2.8, 4.4), (4.0, 6.0)]
    found = sorted(point for one in plan.walls for point in (one.start, one.end))
    assert [coordinate for point in found for coordinate in point] == pytest.approx(sum(expected, ()), abs=1e-5)
    assert {wall.thickness_m for wall in plan.walls} == {0.3}
    assert [*plan.doors[0].start, *plan.doors[0].end] == pytest.approx([2.2, 3.6, 2.8, 4.4], abs=1e-5)


def test_walls_that_are_cut_where_they_meet_are_straight(tmp_path):
    """A corner in which both walls are cut at 45 degrees."""
    house = House()
    house.storey("EG", 0.0)
    house.prism("IfcWallStandardCase", [[(0.0, 0.0), (5.0, 0.0), (4.8, 0.2), (0.0, 0.2)]])
    house.prism("IfcWallStandardCase", [[(5.0, 0.0), (5.0, 4.0), (4.8, 4.0), (4.8, 0.2)]])
    plan = read(tmp_path, house).plan
    assert (len(plan.walls), len(plan.blocks)) == (2, 0)
    corner = shapely.Polygon([(0, 0), (5, 0), (5, 4), (4.8, 4), (4.8, 0.2), (0, 0.2)])
    assert solid(plan).symmetric_difference(corner).area < 1e-6


def test_curved_wall_is_a_block_of_its_thickness_with_its_opening(tmp_path):
    house = House()
    house.storey("EG", 0.0)
    angles = [math.pi * step / 40 for step in range(41)]
    outer, inner = ([(r * math.cos(a), r * math.sin(a)) for a in angles] for r in (5.0, 4.7))
    wall = house.prism("IfcWall", [[*outer, *inner[::-1]]])
    hole = house._entity("IfcOpeningElement")
    api.geometry.assign_representation(house.file, product=hole, representation=house._box(1.0, 2.0, 2.1))
    api.geometry.edit_object_placement(house.file, product=hole, matrix=placed(-0.5, 4.0, 0.0))
    api.feature.add_feature(house.file, feature=hole, element=wall)
    house.filling(hole)
    plan = read(tmp_path, house).plan
    assert (len(plan.walls), len(plan.blocks), len(plan.doors)) == (0, 2, 1)
    assert [block.thickness_m for block in plan.blocks] == pytest.approx([0.3, 0.3], abs=0.005)
    drawn = shapely.Polygon([*outer, *inner[::-1]]).difference(shapely.box(-0.5, 4.0, 0.5, 6.0))
    assert solid(plan).symmetric_difference(drawn).area < 1e-3
    (door,) = plan.doors
    assert [*door.start, *door.end] == pytest.approx([-0.5, 4.85, 0.5, 4.85], abs=0.03)


def test_plan_is_the_section_that_ifcopenshell_makes(tmp_path):
    """Below all windows: what is solid is in a shape of ifcopenshell, with its openings; what is free is not."""
    house = House("IFC2X3", "INCHES")
    house.storey("EG", 3.0)
    south, east, north, west = house.room(low=3.0, high=6.0)
    slanted = house.wall((1.0, 1.0), (4.0, 3.0), 0.15, low=3.0, high=5.0)
    bent = [(4.5, 1.0), (5.0, 1.0), (5.5, 2.5), (5.0, 3.5), (4.6, 3.3), (5.1, 2.5)]
    house.prism("IfcWall", [bent], 2.5, 4.8)
    for wall, at in ((south, 1.0), (slanted, 1.3), (slanted, 2.4)):
        house.filling(house.opening(wall, at, 0.8, low=3.0, high=5.0))
    house.filling(house.opening(east, 1.0, 1.2, low=3.3, high=5.0), "IfcWindow")
    house.opening(north, 2.0, 1.2, low=3.0, high=5.2)
    house.opening(west, 1.0, 1.2, low=3.2, high=5.2)
    plan = read(tmp_path, house).plan
    settings = ifcopenshell.geom.settings()
    settings.set("use-world-coords", True)
    settings.set("iterator-output", ifcopenshell.ifcopenshell_wrapper.NATIVE)
    tree = ifcopenshell.geom.tree()
    tree.add_iterator(ifcopenshell.geom.iterator(settings, house.file, 1, house.file.by_type("IfcWall")))
    drawn = solid(plan)
    points = rng.stream(0, "points").uniform((-0.3, -0.3), (6.3, 4.3), (3000, 2))
    points = points[shapely.distance(drawn.boundary, shapely.points(points)) > 1e-3]
    expected = [bool(tree.select((x, y, 3.15))) for x, y in points.tolist()]
    assert 200 < sum(expected) < len(points) - 200
    assert shapely.contains_xy(drawn, points).tolist() == expected


def test_wall_around_a_room_keeps_the_room_free(tmp_path):
    house = House()
    house.storey("EG", 0.0)
    rings = [[(0, 0), (4, 0), (4, 4), (0, 4)], [(0.3, 0.3), (0.3, 3.7), (3.7, 3.7), (3.7, 0.3)]]
    house.prism("IfcWall", rings)
    plan = read(tmp_path, house).plan
    drawn = shapely.Polygon(*[rings[0], rings[1:]])
    assert solid(plan).symmetric_difference(drawn).area < 1e-6
    assert {block.thickness_m for block in plan.blocks} == {0.3}


def test_columns_are_solid_pillars(tmp_path):
    house = House()
    house.storey("EG", 0.0)
    house.room()
    house.round_column(2.0, 2.0, 0.3)
    house.round_column(4.0, 2.0, 0.25, wall=0.01)
    house.wall((3.0, 1.0), (3.0, 1.4), 0.4, ifc_class="IfcColumn")
    plan = read(tmp_path, house).plan
    assert {block.kind for block in plan.blocks} == {"pillar"}
    areas = sorted(shapely.Polygon(block.polygon).area for block in plan.blocks)
    # A mesh lies within its circle.
    assert areas == pytest.approx([0.16, math.pi * 0.25**2, math.pi * 0.3**2], rel=0.03)


def test_what_is_no_wall_is_counted(tmp_path):
    house = House()
    house.storey("EG", 0.0)
    house.room()
    stair = house.add("IfcStair", None, placed(0.0, 0.0, 0.0))
    house.wall((1.0, 1.0), (3.0, 1.0), ifc_class="IfcMember", of=stair)
    for name in ("IfcSlab", "IfcFurnishingElement", "IfcFurnishingElement", "IfcRailing"):
        house.wall((1.0, 1.0), (3.0, 1.0), ifc_class=name)
    empty = house.add("IfcWall", None, placed(0.0, 0.0, 0.0))
    found = read(tmp_path, house)
    assert len(found.plan.walls) == 4
    assert [block.name for block in found.plan.blocks] == [f"stairs_{stair.id()}"]
    assert "left out: 2 IfcFurnishingElement, 1 IfcRailing, 1 IfcSlab" in found.notes
    assert f"without a shape that can be read, left out: 1 IfcWall (#{empty.id()})" in found.notes


def test_survey_coordinates_are_moved_and_the_plan_says_so(tmp_path):
    house = House()
    api.geometry.edit_object_placement(house.file, product=house.site, matrix=placed(691_000.25, 5_334_000.5, 0.0))
    storey = house.storey("EG", 0.0, placement=False)
    api.geometry.edit_object_placement(house.file, product=storey, matrix=placed(691_000.25, 5_334_000.5, 0.0))
    south, *_ = (house.wall(*[(x + 691_000.25, y + 5_334_000.5) for x, y in ends]) for ends in (SOUTH, EAST))
    plan = read(tmp_path, house).plan
    assert plan.drawing_offset_m is not None
    back = [
        (x + plan.drawing_offset_m[0], y + plan.drawing_offset_m[1])
        for x, y in (plan.walls[0].start, plan.walls[0].end)
    ]
    assert sorted(back) == [pytest.approx((x + 691_000.25, y + 5_334_000.5), abs=1e-5) for x, y in SOUTH]
    assert max(map(abs, plan.walls[0].start)) < 100.0
    assert south.is_a("IfcWall")


def test_all_storeys_have_the_same_coordinates(tmp_path):
    house = House()
    house.storey("EG", 0.0)
    house.room(width=8.0)
    house.storey("OG", 3.0)
    house.wall((20_001.0, 1.0), (20_004.0, 1.0), low=3.0, high=6.0)
    plans = [read(tmp_path, house, level=name).plan for name in ("EG", "OG")]
    assert plans[0].drawing_offset_m == plans[1].drawing_offset_m


def test_command_imports_a_storey_with_a_picture(tmp_path, monkeypatch, capsys):
    house = House()
    for name, floor_m in (("EG", 0.0), ("OG", 3.0)):
        house.storey(name, floor_m)
        south, *_ = house.room(low=floor_m, high=floor_m + 2.5)
        house.filling(house.opening(south, 1.0, 0.9, low=floor_m, high=floor_m + 2.1))
    house.write(tmp_path)
    monkeypatch.chdir(tmp_path)
    assert main(["plan", "import", "house.ifc", "--level", "OG", "--png", "p.png"]) == 0
    said = capsys.readouterr()
    counts = "4 straight walls in 5 pieces, 0 blocks, 0 columns, 1 door"
    assert said.out == f"plan.yaml: storey OG, 7 x 5 m, {counts}\np.png\n"
    assert "robotteamsim: warning: storey EG: left out; --level 'EG' imports it\n" in said.err
    assert Path("p.png").stat().st_size > 1000
