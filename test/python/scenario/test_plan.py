"""Outlines of a plan's elements and the occupancy grid made from them."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.floor_plan import BayRow, Block, Bounds, Door, FloorPlan, Wall
from robotteamsim.scenario.plan import (
    FREE,
    OCCUPIED,
    door_corners,
    obstacles,
    occupancy_grid,
    painted_lines,
    rectangle_of,
    solids,
    wall_corners,
)


def _plan(**elements: tuple) -> FloorPlan:
    return FloorPlan(name="room", bounds=Bounds(min=(-1.0, -2.0), max=(9.0, 5.0)), **elements)


def test_wall_corners_are_half_a_thickness_from_its_line_counter_clockwise() -> None:
    wall = Wall(name="w", start=(1.0, 2.0), end=(4.0, 2.0), thickness_m=0.5)
    assert wall_corners(wall) == ((1.0, 1.75), (4.0, 1.75), (4.0, 2.25), (1.0, 2.25))


def test_slanted_wall_has_its_length_and_thickness() -> None:
    wall = Wall(name="w", start=(0.0, 0.0), end=(3.0, 4.0), thickness_m=0.2)
    outline = shapely.Polygon(wall_corners(wall))
    assert outline.area == pytest.approx(5.0 * 0.2)
    assert outline.exterior.is_ccw
    assert outline.centroid.coords[0] == pytest.approx((1.5, 2.0))


def test_door_corners_are_those_of_its_closed_leaf() -> None:
    door = Door(name="d", start=(0.0, 0.0), end=(0.0, 1.0), thickness_m=0.1)
    assert door_corners(door) == ((0.05, 0.0), (0.05, 1.0), (-0.05, 1.0), (-0.05, 0.0))


def test_clockwise_block_comes_out_counter_clockwise() -> None:
    block = Block(name="b", polygon=((0.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.0, 0.0)))
    (solid,) = solids(_plan(blocks=(block,)))
    assert solid.polygon.exterior.is_ccw
    assert solid.kind == "block"
    assert solid.element is block


def test_open_door_is_solid_only_when_closed() -> None:
    plan = _plan(doors=(Door(name="gate", start=(0.0, 0.0), end=(0.0, 1.0)),))
    assert solids(plan) == ()
    assert [solid.name for solid in solids(plan, {"gate": True})] == ["gate"]


def test_unknown_door_is_rejected_by_name() -> None:
    with pytest.raises(ScenarioError, match="room: unknown door 'gate'; known: none"):
        solids(_plan(), {"gate": True})


def test_empty_plan_has_no_obstacles_and_only_free_cells() -> None:
    assert obstacles(_plan()).is_empty
    grid = occupancy_grid(_plan(), 0.5)
    assert grid.cells.shape == (14, 20)
    assert np.all(grid.cells == FREE)


def test_axis_aligned_wall_on_cell_borders_fills_exactly_its_cells() -> None:
    grid = occupancy_grid(_plan(walls=(Wall(name="w", start=(1.0, 0.0), end=(3.0, 0.0)),)), 0.1)
    expected = np.full((70, 100), FREE, dtype=np.int8)
    expected[19:21, 20:40] = OCCUPIED
    np.testing.assert_array_equal(grid.cells, expected)


def test_closed_door_is_occupied_and_open_door_is_free() -> None:
    plan = _plan(doors=(Door(name="gate", start=(0.0, 0.0), end=(0.0, 1.0), closed=True),))
    closed, opened = occupancy_grid(plan, 0.05), occupancy_grid(plan, 0.05, {"gate": False})
    assert closed.cells[closed.cell_at(0.0, 0.5)] == OCCUPIED
    assert opened.cells[opened.cell_at(0.0, 0.5)] == FREE


def test_grid_covers_bounds_that_are_not_a_multiple_of_the_resolution() -> None:
    grid = occupancy_grid(FloorPlan(name="p", bounds=Bounds(max=(1.0, 1.01))), 0.1)
    assert grid.cells.shape == (11, 10)


def test_cells_and_points_of_the_map_belong_together() -> None:
    grid = occupancy_grid(_plan(), 0.5)
    assert grid.cell_at(-1.0, -2.0) == (0, 0)
    assert grid.cell_center(0, 0) == (-0.75, -1.75)
    assert grid.cell_at(*grid.cell_center(13, 19)) == (13, 19)


@pytest.mark.parametrize("resolution_m", [0.0, -0.1, math.nan, math.inf])
def test_resolution_must_be_finite_and_above_zero(resolution_m: float) -> None:
    with pytest.raises(ValueError, match="resolution_m must be finite and > 0"):
        occupancy_grid(_plan(), resolution_m)


@pytest.mark.parametrize("resolution_m", [1e-4, 1e-9, 1e-200, 5e-324])
def test_resolution_that_makes_too_many_cells_is_rejected_before_they_are_made(resolution_m: float) -> None:
    with pytest.raises(ValueError, match=r"^resolution_m \S+ (makes a map of|is too small for a plan of)"):
        occupancy_grid(_plan(), resolution_m)


@pytest.mark.slow
@settings(max_examples=40)
@given(
    radii_m=st.lists(st.floats(0.3, 3.0), min_size=3, max_size=9),
    center=st.tuples(st.floats(-2.0, 10.0), st.floats(-3.0, 6.0)),
    end=st.tuples(st.floats(2.0, 9.0), st.floats(-2.0, 5.0)),
)
def test_grid_equals_a_polygon_test_of_every_cell(
    radii_m: list[float], center: tuple[float, float], end: tuple[float, float]
) -> None:
    """Star-shaped blocks, concave ones too, and slanted walls, also across the bounds, against shapely."""
    angles = np.linspace(0.0, math.tau, len(radii_m), endpoint=False)
    star = [(center[0] + r * math.cos(a), center[1] + r * math.sin(a)) for r, a in zip(radii_m, angles, strict=True)]
    inside = [(min(max(x, -1.0), 9.0), min(max(y, -2.0), 5.0)) for x, y in star]
    blocks = ()
    if shapely.Polygon(inside).is_valid and shapely.Polygon(inside).area > 1e-3:
        blocks = (Block(name="star", polygon=tuple(inside)),)
    plan = _plan(blocks=blocks, walls=(Wall(name="slant", start=(0.0, 0.0), end=end, thickness_m=0.3),))
    grid = occupancy_grid(plan, 0.1)
    rows, columns = grid.cells.shape
    x, y = np.meshgrid(-1.0 + 0.1 * np.arange(columns), -2.0 + 0.1 * np.arange(rows))
    union = obstacles(plan)
    touched = shapely.intersects(union, shapely.box(x, y, x + 0.1, y + 0.1))
    well_inside = shapely.intersects(union, shapely.box(x + 1e-5, y + 1e-5, x + 0.1 - 1e-5, y + 0.1 - 1e-5))
    occupied = grid.cells == OCCUPIED
    assert np.all(touched[occupied])
    assert np.all(occupied[well_inside])


def test_painted_lines_are_to_the_left_of_the_row() -> None:
    plan = _plan(bays=(BayRow(start=(0.0, 0.0), end=(5.0, 0.0), count=2, depth_m=4.0),))
    assert painted_lines(plan) == (
        ((0.0, 0.0), (0.0, 4.0)),
        ((2.5, 0.0), (2.5, 4.0)),
        ((5.0, 0.0), (5.0, 4.0)),
    )


def test_outline_of_a_turned_square_equals_the_hand_calculation():
    found = rectangle_of(((0.0, -1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)))
    side_m = math.sqrt(2.0)
    assert found is not None
    assert (found.x, found.y, found.yaw) == pytest.approx((0.0, 0.0, math.pi / 4.0))
    assert (found.length_m, found.width_m) == pytest.approx((side_m, side_m))


@pytest.mark.parametrize(
    "corners",
    [
        ((0.0, 0.0), (2.0, 0.0), (3.0, 1.0), (1.0, 1.0)),
        ((0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.1)),
        ((0.0, 0.0), (1.0, 0.0), (1.0, 0.0), (0.0, 0.0)),
        ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0)),
    ],
    ids=["parallelogram", "no parallel sides", "flat", "triangle"],
)
def test_other_polygons_are_none(corners):
    assert rectangle_of(corners) is None
