from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from scipy import stats

from robotteamsim import rng
from robotteamsim.analysis.report.rank_tests import (
    holm,
    kruskal_wallis,
    mann_whitney,
    mean_shift,
    superiority,
    wilcoxon,
)


def generator():
    return rng.stream(1, "test")


def test_three_against_three_missions_have_at_least_a_p_of_a_tenth():
    assert mann_whitney(np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0])) == pytest.approx(2 / 20)
    # The asymptotic test finds 0.077 and 0.046 here.
    tied = np.array([2, 2, 3]), np.array([4, 4, 4])
    assert mann_whitney(*tied) == pytest.approx(2 / 20)
    assert kruskal_wallis(tied, generator()) == pytest.approx(2 / 20)


@pytest.mark.slow
def test_kruskal_wallis_of_three_small_samples_counts_all_partitions():
    samples = [np.array([1.0, 2.0]), np.array([2.0, 4.0]), np.array([5.0, 6.0])]
    pooled, seen = np.concatenate(samples), stats.kruskal(*samples).statistic
    extreme = [
        stats.kruskal(*np.split(np.array(order), [2, 4])).statistic >= seen - 1e-9
        for order in itertools.permutations(pooled)
    ]
    assert kruskal_wallis(samples, generator()) == pytest.approx(np.mean(extreme))


def test_pairs_that_all_agree_have_the_p_of_their_signs():
    first = np.array([1.0, 2.0, 3.0, 4.0, 5.0])
    assert wilcoxon(first, first + 2.0) == pytest.approx(2 / 2**5)
    assert wilcoxon(first, first) is None
    assert wilcoxon(first[:1], first[1:2]) is None


def test_samples_that_cannot_differ_have_no_p():
    same, one = np.array([5.0, 5.0]), np.array([5.0])
    assert kruskal_wallis([same, same], generator()) is None
    assert kruskal_wallis([same], generator()) is None
    assert mann_whitney(same, one) is None


def test_holm_multiplies_the_least_p_by_the_number_of_tests():
    assert holm([0.01, None, 0.04, 0.03]) == [pytest.approx(0.03), None, pytest.approx(0.06), pytest.approx(0.06)]
    assert holm([None]) == [None]


def test_interval_of_a_difference_of_pairs_is_narrower_than_of_independent_samples():
    first = generator().normal(400.0, 50.0, 20)
    second = first + 10.0 + generator().normal(0.0, 2.0, 20)
    paired, independent = mean_shift(first, second, True), mean_shift(first, second, False)
    assert paired.value == pytest.approx(independent.value)
    assert independent.low < paired.low < paired.high < independent.high


def test_difference_without_spread_has_no_interval():
    shift = mean_shift(np.array([3.0, 3.0]), np.array([4.0, 4.0]), False)
    assert shift.value == 1.0
    assert math.isnan(shift.low)
    assert math.isnan(shift.high)


def test_superiority_counts_ties_half():
    assert superiority(np.array([1.0, 2.0]), np.array([2.0, 3.0]), False) == pytest.approx(3.5 / 4)
    assert superiority(np.array([1.0, 2.0]), np.array([2.0, 2.0]), True) == pytest.approx(1.5 / 2)
