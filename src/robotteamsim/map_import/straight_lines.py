"""Straight lines through chains of edges: optimal segmentation and best-fit lines."""

import math

import numpy as np

Line = tuple[np.ndarray, np.ndarray]
"""A point and a direction of length 1, each float64, shape (2,)."""

_MIN_SINE = 0.02
"""Lines at a smaller angle count as parallel: their meeting point is not reliable."""


def best_runs(starts: np.ndarray, edges: np.ndarray, price: float) -> list[tuple[int, int]]:
    """Split a chain of edges optimally into runs along one straight line each; returns (first, last + 1) of each run.

    Minimises the sum of all edge points' squared distances from the lines, plus a penalty per line, by dynamic
    programming that discards starts of runs as soon as they cannot be optimal [killick2012].

    Args: starts, edges: start of each edge, and vector from its start to its end, float64, shape (n, 2).
    """
    total = np.vstack([np.zeros(6), np.cumsum(_moments(starts - starts[0], edges), axis=0)])
    cost, cut = np.zeros(len(total)), np.zeros(len(total), dtype=int)
    open_starts = np.array([0])
    for end in range(1, len(total)):
        costs = cost[open_starts] + _squared_distance(total[end] - total[open_starts])
        best = int(np.argmin(costs))
        cost[end], cut[end] = costs[best] + price, open_starts[best]
        open_starts = np.append(open_starts[costs < cost[end]], end)
    runs = []
    end = len(edges)
    while end:
        runs.append((int(cut[end]), end))
        end = int(cut[end])
    return runs[::-1]


def fitted_line(starts: np.ndarray, edges: np.ndarray) -> Line:
    """Return the least-squares line through all points of some edges, in their direction.

    It is exactly along an axis if all edges are. Args: as in `best_runs`.
    """
    lengths = np.hypot(*edges.T)
    middle = np.average(starts + 0.5 * edges, axis=0, weights=lengths)
    xx, xy, yy = _scatter(_moments(starts - middle, edges).sum(axis=0))
    angle = 0.5 * math.atan2(2.0 * xy, xx - yy)
    direction = np.array([math.cos(angle), math.sin(angle)])
    if abs(direction).min() < 1e-9:
        direction = direction.round()
    return middle, direction if direction @ edges.sum(axis=0) >= 0.0 else -direction


def meeting_point(one: Line, other: Line) -> np.ndarray | None:
    """Return the intersection of two lines; None if they are nearly parallel."""
    (p, d), (q, e) = one, other
    sine = d[0] * e[1] - d[1] * e[0]
    if abs(sine) < _MIN_SINE:
        return None
    meeting: np.ndarray = p + ((q[0] - p[0]) * e[1] - (q[1] - p[1]) * e[0]) / sine * d
    return meeting


def foot(point: np.ndarray, line: Line) -> np.ndarray:
    """Return the point on a line that is nearest to another point."""
    middle, direction = line
    nearest: np.ndarray = middle + ((point - middle) @ direction) * direction
    return nearest


def _moments(starts: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Return length and integrals of x, y, xx, xy, yy along each edge; float64, shape (n, 6)."""
    x, y = (starts + 0.5 * edges).T
    dx, dy = edges.T
    xx, xy, yy = x * x + dx * dx / 12.0, x * y + dx * dy / 12.0, y * y + dy * dy / 12.0
    moments: np.ndarray = np.stack([np.ones(len(x)), x, y, xx, xy, yy], axis=1) * np.hypot(dx, dy)[:, None]
    return moments


def _scatter(moments: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the integrals of xx, xy, yy around the mean from moments summed over edges, shape (..., 6)."""
    length, x, y, xx, xy, yy = np.moveaxis(moments, -1, 0)
    return xx - x * x / length, xy - x * y / length, yy - y * y / length


def _squared_distance(moments: np.ndarray) -> np.ndarray:
    """Return the integral of the squared distance from the best line."""
    xx, xy, yy = _scatter(moments)
    distances: np.ndarray = np.maximum(0.5 * (xx + yy - np.sqrt((xx - yy) ** 2 + 4.0 * xy * xy)), 0.0)
    return distances
