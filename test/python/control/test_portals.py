"""Paths over portals, compared with Dijkstra's algorithm of SciPy."""

import itertools
import math

import numpy as np
import pytest
from scipy.sparse import lil_matrix
from scipy.sparse.csgraph import dijkstra

from robotteamsim import _core

CELL_M = 0.5
ROWS, COLUMNS = 18, 40


def random_grid(seed: int) -> tuple[np.ndarray, list[tuple[tuple[float, float], tuple[float, float], float]]]:
    """Return blocked cells, with a wall in the middle that nothing but portals passes, and portals."""
    rng = np.random.default_rng(seed)
    blocked = rng.random((ROWS, COLUMNS)) < 0.2
    blocked[:, 19:21] = True
    free = np.argwhere(~blocked)
    portals = []
    for length_m in (0.1, 3.0, 7.3, 40.0):
        left, right = (free[mask][rng.integers(mask.sum())] for mask in (free[:, 1] < 19, free[:, 1] > 20))
        portals.append((center(*left), center(*right), length_m))
    return blocked, portals


def center(row: int, column: int) -> tuple[float, float]:
    return (column + 0.5) * CELL_M, (row + 0.5) * CELL_M


def lengths_by_scipy(blocked: np.ndarray, portals: list, start: tuple[int, int]) -> np.ndarray:
    graph = lil_matrix((ROWS * COLUMNS, ROWS * COLUMNS))
    for (row, column), (dr, dc) in itertools.product(
        np.argwhere(~blocked).tolist(), itertools.product((-1, 0, 1), repeat=2)
    ):
        r, c = row + dr, column + dc
        if (dr, dc) == (0, 0) or not (0 <= r < ROWS and 0 <= c < COLUMNS) or blocked[r, c]:
            continue
        if dr and dc and (blocked[row, c] or blocked[r, column]):
            continue
        graph[row * COLUMNS + column, r * COLUMNS + c] = CELL_M * math.hypot(dr, dc)
    for a, b, length_m in portals:
        i, j = (int(y / CELL_M) * COLUMNS + int(x / CELL_M) for x, y in (a, b))
        graph[i, j] = graph[j, i] = max(length_m, CELL_M)
    return dijkstra(graph.tocsr(), indices=start[0] * COLUMNS + start[1]).reshape(ROWS, COLUMNS)


@pytest.mark.parametrize("seed", range(8))
def test_paths_over_portals_are_the_shortest(seed: int) -> None:
    blocked, portals = random_grid(seed)
    grid = _core.plan.PlanningGrid(blocked, (0.0, 0.0), CELL_M, 0.0, portals)
    rng = np.random.default_rng(100 + seed)
    free = np.argwhere(~blocked).tolist()
    for start in rng.choice(free, 3).tolist():
        expected_m = lengths_by_scipy(blocked, portals, tuple(start))
        np.testing.assert_allclose(grid.distance_map(center(*start)), expected_m, rtol=1e-6)
        for goal in rng.choice(free, 20).tolist():
            path = grid.shortest_path(center(*start), center(*goal), 1e6)
            assert bool(path) == math.isfinite(expected_m[tuple(goal)])
            steps_m = [step_m(portals, *step) for step in itertools.pairwise(path)]
            assert not path or sum(steps_m) == pytest.approx(expected_m[tuple(goal)], abs=1e-6)
            corners = grid.waypoints(center(*start), center(*goal), 1e6)
            assert all(grid.is_line_free(*leg) or is_portal(portals, *leg) for leg in itertools.pairwise(corners))


def is_portal(portals: list, a: tuple[float, float], b: tuple[float, float]) -> bool:
    return any((a, b) in ((one, other), (other, one)) for one, other, _ in portals)


def step_m(portals: list, a: tuple[float, float], b: tuple[float, float]) -> float:
    ways = [max(length_m, CELL_M) for one, other, length_m in portals if (a, b) in ((one, other), (other, one))]
    return min(ways) if ways else math.dist(a, b)


def test_coarse_paths_lead_over_portals() -> None:
    """Two rooms of 8 x 8 m that only a portal of 5 m joins; cells of 1 m."""
    blocked = np.zeros((16, 40), dtype=bool)
    blocked[:, 16:24] = True
    portal = (center(8, 2), center(8, 37), 5.0)
    grid = _core.plan.PlanningGrid(blocked, (0.0, 0.0), CELL_M, 0.0, [portal])
    paths = _core.control.CellPaths(grid=grid, origin_m=(0.0, 0.0), cell_m=1.0, rows=8, columns=20, kept_out=None)
    start, goal = paths.cell_of((6.5, 4.5)), paths.cell_of((13.5, 4.5))
    expected_m = float(grid.distance_map((6.5, 4.5))[8, 26])
    assert paths.length_m(start, goal) == pytest.approx(expected_m, abs=1.5)
    position = (6.5, 4.5)
    for _ in range(40):  # walk as a robot does: ahead, and through the portal where the place ahead is beyond it
        ahead = paths.ahead(position, goal, 2.0)
        assert ahead is not None
        position = ahead
        if math.dist(position, (13.5, 4.5)) < 0.8:
            break
    assert math.dist(position, (13.5, 4.5)) < 0.8


@pytest.mark.parametrize(
    ("portal", "problem"),
    [
        (((0.2, 0.2), (1.2, 1.2), 0.0), "the length of a portal"),
        (((0.2, 0.2), (1.2, 1.2), math.nan), "the length of a portal"),
        (((0.2, math.inf), (1.2, 1.2), 1.0), "an end of a portal"),
        (((0.2, 0.2), (1.2, 1.2), 1e6), "longer than a million cells"),
    ],
)
def test_portals_without_a_length_or_a_place_are_refused(portal: tuple, problem: str) -> None:
    with pytest.raises(ValueError, match=problem):
        _core.plan.PlanningGrid(np.zeros((4, 4), dtype=bool), (0.0, 0.0), CELL_M, 0.0, [portal])
