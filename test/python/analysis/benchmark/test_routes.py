"""The longest route of a team: by hand, and against all divisions and orders."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from robotteamsim import rng
from robotteamsim.analysis.benchmark.routes import MAX_EXACT, longest_route


def brute_force(starts: np.ndarray, legs: np.ndarray) -> float:
    """Return the least longest route over all divisions of the goals and all orders."""
    num_robots, num_goals = starts.shape
    best = math.inf
    for owners in itertools.product(range(num_robots), repeat=num_goals):
        longest = 0.0
        for robot in range(num_robots):
            own = [goal for goal in range(num_goals) if owners[goal] == robot]
            routes = [
                starts[robot, order[0]] + sum(legs[a, b] for a, b in itertools.pairwise(order))
                for order in itertools.permutations(own)
                if order
            ]
            longest = max(longest, min(routes, default=0.0))
        best = min(best, longest)
    return best


def test_two_robots_between_two_goals_go_to_one_each():
    # On a line: robots at 0 and 10, goals at 2 and 9.
    starts = np.array([[2.0, 9.0], [8.0, 1.0]])
    legs = np.array([[0.0, 7.0], [7.0, 0.0]])
    assert longest_route(starts, legs) == 2.0
    assert longest_route(starts[:1], legs) == 9.0


@pytest.mark.parametrize("seed", range(8))
def test_route_is_the_optimum_of_all_divisions_and_orders(seed):
    generator = rng.stream(seed, "routes")
    starts = generator.uniform(0.0, 10.0, (1 + seed % 3, 4))
    legs = generator.uniform(0.0, 10.0, (4, 4))  # Without symmetry or triangle inequality.
    assert longest_route(starts, legs) == pytest.approx(brute_force(starts, legs))


def test_many_goals_have_a_bound_that_is_not_above_the_optimum():
    generator = rng.stream(1, "many")
    places = generator.uniform(0.0, 10.0, (MAX_EXACT + 3, 2))
    starts, goals = places[:2], places[2:]
    from_starts = np.hypot(*(starts[:, None] - goals[None]).T).T
    legs = np.hypot(*(goals[:, None] - goals[None]).T).T
    bound = longest_route(from_starts, legs)
    exact = longest_route(from_starts[:, :MAX_EXACT], legs[:MAX_EXACT, :MAX_EXACT])
    # Any tour through all goals is longer than one through some of them, and the bound is not trivial.
    nearest_neighbour_m, at, left = from_starts[0, 0], 0, set(range(1, len(goals)))
    while left:
        after = min(left, key=lambda goal: legs[at, goal])
        nearest_neighbour_m, at, left = nearest_neighbour_m + legs[at, after], after, left - {after}
    assert from_starts.min(axis=0).max() <= bound <= nearest_neighbour_m
    assert bound > 0.3 * exact


def test_goal_that_nobody_reaches_takes_forever_and_no_goal_takes_no_time():
    assert longest_route(np.array([[1.0, math.inf]]), np.zeros((2, 2))) == math.inf
    assert longest_route(np.zeros((2, 0)), np.zeros((0, 0))) == 0.0
