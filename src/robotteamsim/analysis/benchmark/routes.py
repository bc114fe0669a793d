"""The shortest longest route of a team that visits all goals: a relaxation of the multi-robot routing problem."""

from __future__ import annotations

import math

import numpy as np

MAX_EXACT = 10
"""Up to this many goals all subsets are compared; beyond, weaker bounds are used."""


def longest_route(starts: np.ndarray, legs: np.ndarray) -> float:
    """Return a lower bound on the longest route if robots visit all goals together, each goal by one robot.

    Up to MAX_EXACT goals it is the optimum for these lengths: the least, over all divisions of the goals among the
    robots and all orders, of the longest route. Beyond, it is the larger of two bounds: the farthest goal from its
    nearest start; and the shortest forest that links every goal to a start, divided by the number of robots. Lengths
    need not satisfy the triangle inequality.

    Args: starts: lengths from each robot's start to each goal, shape (robots, goals); infinity: unreachable.
          legs: lengths between goals, shape (goals, goals).
    Returns: infinity if a goal cannot be reached by any robot; 0 without goals.
    """
    num_goals = starts.shape[1]
    if num_goals == 0:
        return 0.0
    farthest = float(starts.min(axis=0).max())
    if math.isinf(farthest):
        return math.inf
    if num_goals <= MAX_EXACT:
        return _least_longest(starts, legs)
    return max(farthest, _forest(starts.min(axis=0), legs) / len(starts))


def _least_longest(starts: np.ndarray, legs: np.ndarray) -> float:
    """Return the optimum, by dynamic programming over subsets of the goals as bit sets."""
    full = (1 << starts.shape[1]) - 1
    # Identical robots have identical routes, and robots with the same lengths need only be computed once.
    routes: dict[bytes, np.ndarray] = {}
    best = np.full(full + 1, math.inf)
    best[0] = 0.0
    for robot in starts:
        if robot.tobytes() not in routes:
            routes[robot.tobytes()] = _shortest_routes(robot, legs)
        best = _divided(best, routes[robot.tobytes()])
    return float(best[full])


def _shortest_routes(start: np.ndarray, legs: np.ndarray) -> np.ndarray:
    """Return the length of the shortest route of one robot through each subset of the goals [heldkarp1962]."""
    count = len(start)
    last = np.full((1 << count, count), math.inf)
    for goal in range(count):
        last[1 << goal, goal] = start[goal]
    for subset in range(1, 1 << count):
        onwards = (last[subset][:, None] + legs).min(axis=0)
        for goal in range(count):
            if not subset >> goal & 1:
                joined = subset | 1 << goal
                last[joined, goal] = min(last[joined, goal], onwards[goal])
    shortest = last.min(axis=1)
    shortest[0] = 0.0
    return np.asarray(shortest)


def _divided(others: np.ndarray, route: np.ndarray) -> np.ndarray:
    """Return the least longest route for each subset if one more robot takes any part of it."""
    best = others.copy()
    for subset in range(len(best)):
        part = subset
        while part:
            if route[part] < best[subset]:
                best[subset] = min(best[subset], max(route[part], others[subset ^ part]))
            part = (part - 1) & subset
    return best


def _forest(roots: np.ndarray, legs: np.ndarray) -> float:
    """Return the weight of the shortest forest that links every goal to a root, by Prim's algorithm [prim1957]."""
    away, left, weight = roots.copy(), np.ones(len(roots), dtype=bool), 0.0
    both = np.minimum(legs, legs.T)
    while left.any():
        goal = int(np.argmin(np.where(left, away, math.inf)))
        weight += float(away[goal])
        left[goal] = False
        away = np.minimum(away, both[goal])
    return weight
