"""The planning grid against SciPy's graph search."""

import itertools
import math

import numpy as np
import pytest
from robotteamsim._core.plan import PlanningGrid
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

RESOLUTION_M = 0.1


def random_grid(seed: int, shape: tuple[int, int] = (40, 55)) -> PlanningGrid:
    occupied = np.random.default_rng(seed).random(shape) < 0.03
    occupied[20, 20] = False
    return PlanningGrid(occupied, (-1.0, 2.0), RESOLUTION_M, 0.12)


def center(row: int, col: int) -> tuple[float, float]:
    return -1.0 + (col + 0.5) * RESOLUTION_M, 2.0 + (row + 0.5) * RESOLUTION_M


def graph_of(free: np.ndarray) -> coo_array:
    """Return the 8-connected graph without corner cutting, built the slow and plain way."""
    rows, cols = free.shape
    edges: list[tuple[int, int, float]] = []
    for row, col in np.argwhere(free):
        for d_row, d_col in ((-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1)):
            r, c = row + d_row, col + d_col
            if 0 <= r < rows and 0 <= c < cols and free[r, c] and free[row, c] and free[r, col]:
                edges.append((row * cols + col, r * cols + c, RESOLUTION_M * math.hypot(d_row, d_col)))
    start, end, length = zip(*edges, strict=True)
    return coo_array((length, (start, end)), shape=(rows * cols, rows * cols))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_distance_field_equals_dijkstra_of_scipy(seed):
    grid = random_grid(seed)
    free = grid.blocked() == 0
    goal_row, goal_col = np.argwhere(free)[len(np.argwhere(free)) // 2]
    field = grid.distance_map(center(goal_row, goal_col))
    expected = dijkstra(graph_of(free).tocsr(), indices=goal_row * free.shape[1] + goal_col).reshape(free.shape)
    np.testing.assert_array_equal(np.isinf(field), np.isinf(expected))
    reached = np.isfinite(expected)
    np.testing.assert_allclose(field[reached], expected[reached], rtol=1e-6)


@pytest.mark.parametrize("seed", range(4))
def test_shortest_path_has_the_length_of_the_field_and_stays_free(seed):
    grid = random_grid(seed)
    cells = np.argwhere(grid.blocked() == 0)
    goal = center(*cells[len(cells) // 2])
    field = grid.distance_map(goal)
    for row, col in cells[:: max(1, len(cells) // 12)]:
        path = grid.shortest_path(center(row, col), goal, 100.0)
        if not np.isfinite(field[row, col]):
            assert path == []
            continue
        length = sum(math.dist(a, b) for a, b in itertools.pairwise(path))
        assert length == pytest.approx(float(field[row, col]), abs=1e-5)
        assert all(grid.is_free(point) for point in path)


@pytest.mark.parametrize("seed", range(4))
def test_lines_between_waypoints_are_free_and_not_longer_than_the_path(seed):
    grid = random_grid(seed)
    cells = np.argwhere(grid.blocked() == 0)
    goal = center(*cells[-1])
    for row, col in cells[:: max(1, len(cells) // 12)]:
        path = grid.shortest_path(center(row, col), goal, 100.0)
        corners = grid.waypoints(center(row, col), goal, 100.0)
        assert all(grid.is_line_free(a, b) for a, b in itertools.pairwise(corners))
        assert sum(math.dist(a, b) for a, b in itertools.pairwise(corners)) <= 1e-9 + sum(
            math.dist(a, b) for a, b in itertools.pairwise(path)
        )


@pytest.mark.slow
def test_free_lines_touch_no_blocked_cell():
    grid = random_grid(7)
    blocked = grid.blocked() != 0
    rng = np.random.default_rng(7)
    for _ in range(300):
        a, b = (tuple(rng.uniform((-1.0, 2.0), (4.5, 6.0))) for _ in range(2))
        samples = np.linspace(a, b, 2000)
        cols, rows = ((samples - (-1.0, 2.0)) / RESOLUTION_M).astype(int).T
        if grid.is_line_free(a, b):
            assert not blocked[rows, cols].any()
        else:
            # Samples may miss the corner of a cell that the exact test sees, so widen them by a hair.
            near = [blocked[np.clip(rows + d, 0, 39), np.clip(cols + e, 0, 54)] for d in (-1, 0, 1) for e in (-1, 0, 1)]
            assert np.any(near)


def test_searches_do_not_depend_on_earlier_searches():
    first, second = random_grid(3), random_grid(3)
    cells = np.argwhere(first.blocked() == 0)
    a, b, c = (center(*cells[i]) for i in (5, len(cells) // 2, len(cells) - 5))
    first.waypoints(a, c, 100.0)
    first.nearest_reachable(c, a, 2.0)
    assert first.waypoints(a, b, 100.0) == second.waypoints(a, b, 100.0)


def test_grid_rejects_a_flat_array():
    with pytest.raises(TypeError, match="incompatible function arguments"):
        PlanningGrid(np.zeros(4, dtype=bool), (0.0, 0.0), 0.1, 0.0)


def test_grid_rejects_a_field_of_another_grid():
    with pytest.raises(ValueError, match="one value per cell"):
        random_grid(0).least_reachable(np.zeros((2, 2), dtype=np.float32), center(20, 20), 1.0)
