"""Convex pieces of polygons that hypothesis thinks of."""

import itertools

import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from robotteamsim.scenario.floor_plan import Block, Bounds, FloorPlan
from robotteamsim.scenario.plan import Corners, solids
from robotteamsim.scenario.sections import PlacedRobot, Run
from robotteamsim.world import World
from robotteamsim.world.core_parts import MAX_CORNERS, convex_pieces

AXIS = st.integers(0, 60).map(lambda tenths: 0.1 * tenths)
"""Few values, so that many corners are in line."""

POINTS = st.lists(st.tuples(AXIS, AXIS), min_size=3, max_size=14, unique=True)


def uncrossed(points: list[tuple[float, float]]) -> Corners:
    """Return a ring through points that does not cross itself: what crosses is turned round until nothing does."""
    ring, crossed = list(points), True
    while crossed:
        crossed = False
        for i, j in itertools.combinations(range(len(ring)), 2):
            first = shapely.LineString([ring[i], ring[i + 1]])
            second = shapely.LineString([ring[j], ring[(j + 1) % len(ring)]])
            if first.crosses(second):
                ring[i + 1 : j + 1] = ring[i + 1 : j + 1][::-1]
                crossed = True
    return tuple(shapely.geometry.polygon.orient(shapely.Polygon(ring)).exterior.coords[:-1])


@st.composite
def polygons(draw: st.DrawFn) -> Corners:
    corners = uncrossed(draw(POINTS))
    outline = shapely.Polygon(corners)
    assume(outline.is_valid and outline.area > 0.01)
    return corners


@pytest.mark.slow
@settings(max_examples=150)
@given(corners=polygons())
def test_pieces_are_convex_have_few_corners_and_cover_the_polygon_exactly(corners):
    outline = shapely.Polygon(corners)
    pieces = [shapely.Polygon(piece) for piece in convex_pieces(corners)]
    for piece in pieces:
        assert 3 <= len(piece.exterior.coords) - 1 <= MAX_CORNERS
        assert piece.exterior.is_ccw
        assert piece.convex_hull.area == pytest.approx(piece.area, abs=1e-12)
    assert sum(piece.area for piece in pieces) == pytest.approx(outline.area, abs=1e-9)
    assert shapely.union_all(pieces).symmetric_difference(outline).area == pytest.approx(0.0, abs=1e-9)


@settings(max_examples=50)
@given(corners=polygons())
def test_every_block_of_a_plan_becomes_bodies_of_a_world(corners):
    plan = FloorPlan(
        name="block", bounds=Bounds(max=(20.0, 20.0)), blocks=(Block(name="block", polygon=corners[::-1]),)
    )
    world = World(plan, [PlacedRobot(start_pose=(10.0, 10.0, 0.0))], Run())
    assert world.num_robots == 1
    assert shapely.Polygon(solids(plan)[0].corners).exterior.is_ccw
