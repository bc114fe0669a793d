"""From cells to vectors."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from shapely.affinity import rotate

from robotteamsim.map_import.outlines import outlines
from robotteamsim.scenario.floor_plan import Block, Bounds, FloorPlan
from robotteamsim.scenario.plan import OCCUPIED, occupancy_grid


def _drawn(polygon: shapely.Polygon) -> np.ndarray:
    """Return the cells that a polygon within 0..200 touches."""
    block = Block(name="block", polygon=tuple(map(tuple, shapely.get_coordinates(polygon)[:-1].tolist())))
    plan = FloorPlan(name="plan", bounds=Bounds(max=(200.0, 200.0)), blocks=(block,))
    return occupancy_grid(plan, 1.0).cells == OCCUPIED


@pytest.mark.parametrize("angle_deg", [1.5, 3.0, 7.0, 15.0, 30.0, 44.0, 45.0, 61.0, 88.0])
@pytest.mark.parametrize(("length", "width"), [(150.0, 4.0), (120.0, 6.3), (30.0, 12.0)])
def test_slanted_wall_comes_back_where_it_was_drawn_from(angle_deg: float, length: float, width: float) -> None:
    wall = rotate(shapely.box(100 - length / 2, 100 - width / 2, 100 + length / 2, 100 + width / 2), angle_deg)
    (outline,) = outlines(_drawn(wall))
    assert shapely.hausdorff_distance(outline.boundary, wall.boundary, densify=0.01) < 1.5
    assert outline.symmetric_difference(wall).area < 0.5 * wall.length
    assert len(shapely.get_coordinates(outline.simplify(0.2))) <= 9


def test_edges_along_the_axes_stay_where_they_are() -> None:
    solid = np.zeros((60, 80), dtype=bool)
    solid[5:8, 4:70] = solid[8:50, 4:9] = solid[30:34, 40:60] = solid[8:10, 30:34] = True
    drawn = shapely.union_all([shapely.box(4, 5, 70, 8), shapely.box(4, 8, 9, 50), shapely.box(30, 8, 34, 10)])
    found = sorted(outlines(solid), key=lambda polygon: -polygon.area)
    assert [shapely.normalize(shapely.simplify(polygon, 0.0)) for polygon in found] == [
        shapely.normalize(shapely.simplify(polygon, 0.0)) for polygon in (drawn, shapely.box(40, 30, 60, 34))
    ]


def test_hole_stays_open() -> None:
    solid = np.ones((40, 60), dtype=bool)
    solid[3:-3, 3:-3] = False
    (outline,) = outlines(solid)
    assert [shapely.Polygon(hole).area for hole in outline.interiors] == [34.0 * 54.0]


@pytest.mark.parametrize("size", [(1, 3), (2, 2), (3, 3), (2, 5), (6, 6)])
def test_small_pillar_keeps_its_cells(size: tuple[int, int]) -> None:
    solid = np.zeros((20, 20), dtype=bool)
    solid[5 : 5 + size[0], 5 : 5 + size[1]] = True
    (outline,) = outlines(solid)
    assert outline.equals(shapely.box(5, 5, 5 + size[1], 5 + size[0]))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
def test_outlines_of_any_cells_are_valid_and_near(seed: int) -> None:
    generator = np.random.default_rng(seed)
    grown = generator.random((60, 60)) < generator.uniform(0.1, 0.5)
    solid = np.zeros((60, 60), dtype=bool)
    solid[1:-1, 1:-1] = grown[1:-1, 1:-1] | grown[:-2, 1:-1] | grown[1:-1, :-2]
    while True:  # no two cells touch by a corner alone
        a, b, c, d = solid[:-1, :-1], solid[:-1, 1:], solid[1:, :-1], solid[1:, 1:]
        touching = (~a & b & c & ~d) | (a & ~b & ~c & d)
        if not touching.any():
            break
        a |= touching
        b |= touching
    found = outlines(solid)
    assert all(polygon.is_valid for polygon in found)
    cells = shapely.union_all([shapely.box(x, y, x + 1, y + 1) for y, x in zip(*np.nonzero(solid), strict=True)])
    union = shapely.union_all(found)
    assert cells.buffer(2.0).covers(union)
    assert union.buffer(3.5).covers(cells)
