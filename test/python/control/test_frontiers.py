"""Frontiers of a map, and what may be seen from them."""

import math

import numpy as np
import pytest

from robotteamsim.control.exploration.frontiers import discount, frontier_cells, frontiers, gains_m2
from robotteamsim.control.exploration.random_tree import RandomTree
from robotteamsim.scenario.plan import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

CELL_M = 0.1


def grid_of(cells):
    return OccupancyGrid((0.0, 0.0), CELL_M, cells)


@pytest.fixture
def corridor():
    """Return a known corridor, 1 m wide, from x = 0 to 6 m, which goes on unknown to the right."""
    cells = np.full((30, 120), UNKNOWN, np.int8)
    cells[10:20, :60] = FREE
    cells[9, :], cells[20, :] = OCCUPIED, OCCUPIED
    return grid_of(cells)


def test_only_the_end_of_the_known_floor_is_a_frontier(corridor):
    lengths_m = np.where(corridor.cells == FREE, np.arange(120) * CELL_M, np.inf)
    found = frontiers(corridor, frontier_cells(corridor), lengths_m, 5.0)
    assert len(found) == 1
    assert found.places_m[0] == pytest.approx((5.95, 1.05))
    assert found.paths_m[0] == pytest.approx(5.9)


def test_floor_that_cannot_be_reached_has_no_frontier(corridor):
    assert len(frontiers(corridor, frontier_cells(corridor), np.full(corridor.cells.shape, np.inf), 5.0)) == 0


def test_gain_of_a_place_in_the_open_is_the_disc_of_the_laser():
    gain = gains_m2(grid_of(np.full((200, 200), UNKNOWN, np.int8)), np.array([[10.0, 10.0]]), 5.0)
    assert gain == pytest.approx(math.pi * 25.0, rel=0.06)


def test_gain_ends_at_walls_and_at_the_border_and_leaves_out_what_is_known(corridor):
    (gain,) = gains_m2(corridor, np.array([[5.95, 1.45]]), 5.0)
    # Half the plane lies ahead, but the corridor is 1 m wide and 6 m long.
    assert 3.0 < gain < 6.0
    (nothing,) = gains_m2(corridor, np.array([[0.5, 1.5]]), 3.0)
    assert nothing == 0.0


def test_goals_of_teammates_count_less_with_distance():
    places_m = np.array([[0.0, 0.0], [2.5, 0.0], [10.0, 0.0]])
    assert discount(places_m, [(0.0, 0.0)], 5.0) == pytest.approx([0.05, 0.5, 1.0])
    assert discount(places_m, [], 5.0) == pytest.approx([1.0, 1.0, 1.0])


def test_random_tree_finds_the_end_of_a_corridor_and_nothing_else(corridor):
    tree = RandomTree((1.0, 1.5), np.random.default_rng(2))
    for _ in range(20):
        found = tree.grow(corridor)
    all_of_them = {tuple(cell) for cell in frontier_cells(corridor).tolist()}
    assert len(found) >= 3
    assert {tuple(cell) for cell in found.tolist()} <= all_of_them


def test_random_tree_grows_from_a_robot_that_does_not_see_where_it_stands(corridor):
    corridor.cells[14:17, 8:12] = UNKNOWN
    tree = RandomTree((1.0, 1.5), np.random.default_rng(2))
    found = [tree.grow(corridor) for _ in range(20)][-1]
    assert found[:, 1].max() == 59


def test_random_tree_forgets_frontiers_that_are_known_by_now(corridor):
    tree = RandomTree((5.0, 1.5), np.random.default_rng(2))
    assert len(tree.grow(corridor)) > 0
    known = corridor.cells.copy()
    known[10:20, :] = FREE
    assert len(tree.grow(grid_of(np.where(known == UNKNOWN, OCCUPIED, known)))) == 0
