import pytest
import shapely

from robotteamsim.nodes.scene.building import building_markers, door_markers
from robotteamsim.scenario import load
from robotteamsim.scenario.floor_plan import Block, Bounds, Door, FloorPlan, Wall
from robotteamsim.scenario.plan import leaf_corners

PLAN = FloorPlan(
    name="two rooms",
    bounds=Bounds(max=(10.0, 6.0)),
    walls=(
        Wall(name="south", start=(0.0, 0.1), end=(10.0, 0.1)),
        Wall(name="north", start=(0.0, 5.9), end=(10.0, 5.9)),
        Wall(name="west", start=(0.1, 0.2), end=(0.1, 5.8), height_m=0.5),
        Wall(name="crossing", start=(2.0, 0.0), end=(2.0, 6.0)),
    ),
    blocks=(
        Block(name="core", polygon=((5.0, 2.0), (7.0, 2.0), (7.0, 4.0), (6.0, 4.0), (6.0, 3.0), (5.0, 3.0))),
        Block(name="pillar", kind="pillar", polygon=((8.0, 2.0), (8.5, 2.0), (8.5, 2.5), (8.0, 2.5))),
    ),
    doors=(
        Door(name="gate", start=(3.0, 3.0), end=(4.0, 3.0)),
        Door(name="fire", start=(3.0, 5.0), end=(4.0, 5.0), kind="fireproof"),
    ),
)


def triangles(item):
    z = item.position[2]
    corners = [(x, y, z + height_m) for x, y, height_m in item.points]
    return [corners[i : i + 3] for i in range(0, len(corners), 3)]


def only(markers, namespace, marker_id=0):
    (found,) = [item for item in markers if (item.ns, item.id) == (namespace, marker_id)]
    return found


@pytest.mark.parametrize("plan", [PLAN, load("garage_sar").plan], ids=lambda plan: plan.name)
def test_ids_are_unique(plan):
    states = {door.name: 1.0 for door in plan.doors}
    markers = building_markers(plan, 1.0) + door_markers(plan, states, 1.0)
    assert len({(item.ns, item.id) for item in markers}) == len(markers)
    assert all(len(item.points) == len(item.tints) > 0 for item in markers)


def test_walls_stand_from_the_floor_to_the_cut_and_lower_ones_keep_their_height():
    heights = {
        round(z, 6) for triangle in triangles(only(building_markers(PLAN, 1.0), "walls")) for _, _, z in triangle
    }
    assert heights == {0.0, 0.5, 1.0}


def test_tops_of_walls_cover_each_spot_once_where_walls_cross():
    tops = [
        shapely.Polygon([(x, y) for x, y, _ in triangle])
        for triangle in triangles(only(building_markers(PLAN, 1.0), "walls"))
        if {z for _, _, z in triangle} == {1.0}
    ]
    assert sum(top.area for top in tops) == pytest.approx(shapely.union_all(tops).area)
    assert shapely.union_all(tops).area == pytest.approx(2 * 10 * 0.2 + (6 - 2 * 0.2) * 0.2 + 3.0 + 0.25)


def test_sides_are_brighter_toward_the_sun_in_the_north_west():
    item = only(building_markers(PLAN, 1.0), "walls")
    light = {}
    for i in range(0, len(item.points), 3):
        corners, tint = item.points[i : i + 3], item.tints[i]
        light[frozenset(point[0] for point in corners), "x"] = tint[0]
        light[frozenset(point[1] for point in corners), "y"] = tint[0]
    west, east, south, north = (
        light[frozenset({place}), axis] for place, axis in ((8.0, "x"), (8.5, "x"), (2.0, "y"), (2.5, "y"))
    )
    assert min(west, north) > max(east, south)


def test_plan_without_walls_is_a_bare_floor():
    bare = FloorPlan(name="field", bounds=Bounds(max=(3.0, 3.0)))
    assert {item.ns for item in building_markers(bare, 1.0)} == {"floor"}


def leaf(item):
    return shapely.union_all([shapely.Polygon([(x, y) for x, y, _ in t]) for t in triangles(item) if min(t)[2] > 0.5])


def test_closed_door_fills_its_gap_and_open_door_leaves_it():
    gap = shapely.LineString([(3.2, 3.0), (3.8, 3.0)])
    closed, other = door_markers(PLAN, {"gate": 0.0, "fire": 0.0}, 1.0)
    opened, _ = door_markers(PLAN, {"gate": 1.0, "fire": 0.0}, 1.0)
    assert leaf(closed).intersects(gap)
    assert not leaf(opened).intersects(gap)
    assert (closed.ns, closed.id) == (opened.ns, opened.id) != (other.ns, other.id)


def test_leaf_that_swings_or_slides_is_drawn_where_it_is():
    swinging, sliding = (
        PLAN.model_copy(update={"doors": (PLAN.doors[0].model_copy(update={"motion": motion}),)})
        for motion in ("swing", "slide")
    )
    for opening in (0.0, 0.3, 1.0):
        for plan in (swinging, sliding):
            (drawn,) = door_markers(plan, {"gate": opening}, 1.0)
            where = shapely.Polygon(leaf_corners(plan.doors[0], opening))
            assert leaf(drawn).buffer(1e-6).contains(where)


def test_open_door_can_be_seen_through_and_fireproof_door_looks_different():
    def tint(item):
        return item.tints[0][:3]

    closed, fireproof = door_markers(PLAN, {"gate": 0.0, "fire": 0.0}, 1.0)
    opened, _ = door_markers(PLAN, {"gate": 1.0, "fire": 0.0}, 1.0)
    assert closed.tints[0][3] == 1.0 > opened.tints[0][3]
    assert tint(closed) != tint(fireproof)
