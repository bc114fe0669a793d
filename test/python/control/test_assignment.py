"""Assignment of firefighters to victims: both methods, by hand and against each other."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from robotteamsim import rng
from robotteamsim.control.people.dispatch import PRICE_STEP_M, auction, hungarian

METHODS = pytest.mark.parametrize("method", [auction, hungarian])


def total(costs: np.ndarray, pairs: list[tuple[int, int]]) -> float:
    return float(sum(costs[pair] for pair in pairs))


@METHODS
def test_shortest_total_beats_the_nearest_victim_of_each(method):
    # Both are nearest to victim 0; the second would then walk 9 m: 1 + 9 = 10 instead of 2 + 3 = 5.
    assert method(np.array([[1.0, 3.0], [2.0, 9.0]])) == [(0, 1), (1, 0)]


@METHODS
@pytest.mark.parametrize(("rows", "columns"), [(0, 0), (0, 3), (3, 0), (1, 4), (4, 1), (3, 5), (5, 3), (4, 4)])
def test_every_one_of_the_smaller_side_has_a_partner_at_the_least_total(method, rows, columns):
    costs = rng.stream(1, "costs", rows, columns).uniform(0.0, 50.0, (rows, columns))
    pairs = method(costs)
    assert len(pairs) == len({r for r, _ in pairs}) == len({c for _, c in pairs}) == min(rows, columns)
    short, long, is_tall = sorted((rows, columns))[0], max(rows, columns), rows > columns
    least = min(
        sum((costs.T if is_tall else costs)[i, chosen[i]] for i in range(short))
        for chosen in itertools.permutations(range(long), short)
    )
    assert least - 1e-9 <= total(costs, pairs) <= least + PRICE_STEP_M


def test_auction_agrees_with_the_hungarian_method_for_thirty():
    costs = rng.stream(2, "costs").uniform(0.0, 80.0, (20, 30))
    assert total(costs, auction(costs)) == pytest.approx(total(costs, hungarian(costs)), abs=PRICE_STEP_M)
