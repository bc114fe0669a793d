"""Straight lines through chains of edges."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from robotteamsim.map_import.straight_lines import best_runs, fitted_line, foot, meeting_point


def _staircase(rise_per_run: list[tuple[int, int]]) -> tuple[np.ndarray, np.ndarray]:
    """Return starts and edges of steps: right by the first number, then up by the second."""
    edges = np.array([edge for run, rise in rise_per_run for edge in ((run, 0), (0, rise))], dtype=float)
    return np.cumsum(edges, axis=0) - edges, edges


def _drawn_line(slope: float, runs: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the border of the cells under a line from the origin, in steps of one cell up."""
    crossings = [math.ceil(row / slope) for row in range(runs + 1)]
    return _staircase([(b - a, 1) for a, b in itertools.pairwise(crossings)])


def test_staircase_of_one_slope_is_one_run() -> None:
    starts, edges = _drawn_line(0.37, 80)
    assert best_runs(starts, edges, price=5.0) == [(0, len(edges))]


def test_runs_part_where_the_slope_changes() -> None:
    flat, steep = _drawn_line(0.2, 20), _drawn_line(0.9, 40)
    edges = np.concatenate([flat[1], steep[1]])
    starts = np.cumsum(edges, axis=0) - edges
    first, second = best_runs(starts, edges, price=5.0)
    assert first[0] == 0
    assert first[1] == second[0] == pytest.approx(len(flat[1]), abs=3)
    assert second[1] == len(edges)


def test_right_angle_parts_runs_exactly() -> None:
    edges = np.array([(30.0, 0.0), (0.0, 20.0), (-30.0, 0.0), (0.0, -20.0)])
    starts = np.cumsum(edges, axis=0) - edges
    assert best_runs(starts, edges, price=5.0) == [(0, 1), (1, 2), (2, 3), (3, 4)]


def test_dropping_starts_that_cannot_win_changes_nothing() -> None:
    generator = np.random.default_rng(4)
    edges = np.zeros((40, 2))
    edges[::2, 0] = generator.integers(1, 6, 20)
    edges[1::2, 1] = generator.choice([-2.0, -1.0, 1.0, 2.0], 20)
    starts = np.cumsum(edges, axis=0) - edges

    def cost(start: int, end: int) -> float:
        point, direction = fitted_line(starts[start:end], edges[start:end])
        # Simpson's rule is exact for the square of a linear function.
        offsets = [starts[start:end] + part * edges[start:end] - point for part in (0.0, 0.5, 1.0)]
        a, b, c = ((offset[:, 0] * direction[1] - offset[:, 1] * direction[0]) ** 2 for offset in offsets)
        return float(np.sum(np.abs(edges[start:end]).sum(axis=1) * (a + 4.0 * b + c) / 6.0))

    best = [0.0]
    for end in range(1, 41):
        best.append(min(best[start] + cost(start, end) + 5.0 for start in range(end)))
    runs = best_runs(starts, edges, price=5.0)
    assert sum(cost(*run) + 5.0 for run in runs) == pytest.approx(best[-1])


@pytest.mark.parametrize("direction", [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)])
def test_line_of_an_edge_along_an_axis_is_exact(direction: tuple[float, float]) -> None:
    start, edge = np.array([[1234.0, 567.0]]), 37.0 * np.array([direction])
    point, fitted = fitted_line(start, edge)
    assert fitted.tolist() == list(direction)
    assert (point == start[0] + 0.5 * edge[0]).all()


@pytest.mark.parametrize("slope", [0.11, 0.5, 0.83, 1.0])
def test_line_through_a_staircase_has_its_slope_and_direction(slope: float) -> None:
    starts, edges = _drawn_line(slope, 60)
    for sign in (1.0, -1.0):
        _, (x, y) = fitted_line(sign * starts, sign * edges)
        assert y / x == pytest.approx(slope, abs=0.01)
        assert math.copysign(1.0, x) == sign


def test_lines_meet_in_their_common_point_and_parallel_ones_do_not_meet() -> None:
    one = (np.array([0.0, 1.0]), np.array([1.0, 0.0]))
    other = (np.array([5.0, 9.0]), np.array([0.6, 0.8]))
    np.testing.assert_allclose(meeting_point(one, other), [-1.0, 1.0])
    assert meeting_point(one, (np.array([3.0, 3.0]), np.array([-1.0, 0.01]))) is None


def test_foot_is_the_nearest_point_of_a_line() -> None:
    line = (np.array([1.0, 1.0]), np.array([0.6, 0.8]))
    np.testing.assert_allclose(foot(np.array([1.0 - 0.8 + 0.6, 1.0 + 0.6 + 0.8]), line), [1.6, 1.8])
