"""What robots have found, as markers for rviz."""

from __future__ import annotations

import numpy as np
import pytest

from robotteamsim.nodes.scene.found import BEYOND_M, FOUND, WRONG, FoundPicture
from robotteamsim.scenario import load
from robotteamsim.scenario.building import building_of
from robotteamsim.scenario.plan import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

HEIGHT_M = 1.1


@pytest.fixture(scope="module")
def plan():
    return load("tutorial_arena").plan


def grid_with(plan, **cells):
    """Return a map in which nothing is known but some cells, by value, (row, column)."""
    true = building_of(plan).grid(0.1)
    found = np.full(true.cells.shape, UNKNOWN, dtype=np.int8)
    for name, places in cells.items():
        for place in places:
            found[place] = {"free": FREE, "occupied": OCCUPIED}[name]
    return OccupancyGrid(true.origin_m, 0.1, found)


def drawn(plan, maps):
    return {marker.ns: marker for marker in FoundPicture(plan, HEIGHT_M).markers(maps)}


def test_nothing_is_drawn_without_maps(plan):
    assert drawn(plan, {}) == {}


def test_wall_covers_the_true_one_and_a_wrong_one_is_red(plan):
    walls = building_of(plan).grid(0.1).cells == OCCUPIED
    right = tuple(int(i) for i in np.argwhere(walls)[0])
    near = np.zeros(walls.shape, dtype=bool)
    for row, column in np.argwhere(walls):
        near[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2] = True
    wrong = tuple(int(i) for i in np.argwhere(~near)[0])
    # Each of two robots has found one of them.
    maps = {0: grid_with(plan, occupied=[right]), 1: grid_with(plan, occupied=[wrong])}
    marker = drawn(plan, maps)["found_walls"]
    tops = {tint for (_, _, z), tint in zip(marker.points, marker.tints, strict=True) if z > HEIGHT_M}
    assert {FOUND, WRONG} <= tops
    red = [point for point, tint in zip(marker.points, marker.tints, strict=True) if tint == WRONG]
    (x0, y0), (row, column) = plan.bounds.min, wrong
    xs, ys = {round(x, 6) for x, _, _ in red}, {round(y, 6) for _, y, _ in red}
    assert xs == {round(x0 + 0.1 * column - BEYOND_M, 6), round(x0 + 0.1 * (column + 1) + BEYOND_M, 6)}
    assert ys == {round(y0 + 0.1 * row - BEYOND_M, 6), round(y0 + 0.1 * (row + 1) + BEYOND_M, 6)}


def test_floor_that_was_found_has_its_area(plan):
    marker = drawn(plan, {0: grid_with(plan, free=[(30, 30), (30, 31), (31, 31)])})["found_floor"]
    corners = np.array(marker.points)[:, :2].reshape(-1, 3, 2)
    sides, others = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas_m2 = 0.5 * np.abs(sides[:, 0] * others[:, 1] - sides[:, 1] * others[:, 0])
    assert areas_m2.sum() == pytest.approx(0.03)
