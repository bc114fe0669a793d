from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from robotteamsim import rng
from robotteamsim.analysis.report.statistics import (
    bootstrap_mean,
    clopper_pearson,
    fisher_freeman_halton,
    mean_course,
    survival,
)

TIMES_S = np.array([*range(381, 481, 5), 600.0, 600.0])
VICTIMS = {10: np.full(30, 4), 20: np.repeat([2, 3, 4], [6, 9, 15]), 30: np.repeat([2, 3, 4], [28, 1, 1])}
"""Numbers of victims saved in 30 missions at each of three noises."""


def generator():
    return rng.stream(1, "test")


@pytest.mark.parametrize(
    ("successes", "low", "high"), [(30, 0.884, 1.0), (15, 0.313, 0.687), (24, 0.614, 0.923), (2, 0.008, 0.221)]
)
def test_shares_of_30_have_their_known_intervals(successes, low, high):
    share = clopper_pearson(successes, 30)
    assert (round(share.low, 3), round(share.high, 3)) == (low, high)


def test_share_without_success_has_the_rule_of_its_closed_form():
    share = clopper_pearson(0, 30)
    assert share.low == 0.0
    assert share.high == pytest.approx(1.0 - 0.025 ** (1 / 30))
    assert share.low <= 0.05 <= share.high < 0.12


def test_share_of_nothing_is_rejected():
    with pytest.raises(ValueError, match="count must be at least 1"):
        clopper_pearson(0, 0)


def test_bootstrap_interval_is_near_students_where_values_are_normal():
    values = generator().normal(100.0, 10.0, 200)
    found = bootstrap_mean(values, generator())
    wanted = stats.t.interval(0.95, 199, values.mean(), stats.sem(values))
    assert (found.low, found.high) == pytest.approx(wanted, abs=0.25)


@pytest.mark.parametrize("values", [[3.0], [3.0, 3.0, 3.0]])
def test_equal_values_have_an_interval_of_no_width(values):
    found = bootstrap_mean(np.array(values), generator())
    assert (found.value, found.low, found.high) == (3.0, 3.0, 3.0)


def test_random_tables_give_the_exact_p_of_all_tables():
    first, second = np.array([2] * 6 + [3] * 2), np.array([2] * 1 + [3] * 3 + [4] * 3)

    def weight(row):
        return math.prod(math.comb(n, k) for n, k in zip((7, 5, 3), row, strict=True))

    rows = [(a, b, 8 - a - b) for a in range(8) for b in range(6) if 0 <= 8 - a - b <= 3]
    seen = weight((6, 2, 0))
    exact = sum(weight(row) for row in rows if weight(row) <= seen) / math.comb(15, 8)
    assert fisher_freeman_halton([first, second], generator()) == pytest.approx(exact, abs=0.005)


def test_counts_of_victims_differ_between_levels_and_not_from_themselves():
    assert fisher_freeman_halton([VICTIMS[10], VICTIMS[20], VICTIMS[30]], generator()) < 1e-4
    assert fisher_freeman_halton([VICTIMS[20], VICTIMS[20]], generator()) == 1.0
    assert fisher_freeman_halton([np.array([4, 4]), np.array([4])], generator()) is None


def test_single_missions_of_three_settings_tell_nothing():
    assert fisher_freeman_halton([np.array([0]), np.array([1]), np.array([0])], generator()) == 1.0


@pytest.mark.slow
def test_tables_too_large_for_their_probability_to_be_a_number_are_tested_too():
    draws = generator().integers(0, 5, (100, 60))
    assert 0.01 < fisher_freeman_halton(list(draws), generator()) < 0.99
    draws[:50] = np.minimum(draws[:50], 3)
    assert fisher_freeman_halton(list(draws), generator()) < 0.001


def test_survival_curve_of_four_missions_equals_the_hand_calculation():
    curve = survival(np.array([1.0, 2.0, 3.0, 4.0]), np.array([True, True, False, False]), 4.0)
    assert curve.time_s.tolist()[:3] == [0.0, 1.0, 2.0]
    assert curve.share.tolist()[:3] == pytest.approx([1.0, 0.75, 0.5])
    assert curve.share[-1] == pytest.approx(0.5)
    assert curve.censored_s.tolist() == [3.0, 4.0]
    assert np.all((curve.low <= curve.share) & (curve.share <= curve.high))
    greenwood = 0.75 * math.sqrt(1 / (4 * 3))
    half = 1.959964 * greenwood / abs(0.75 * math.log(0.75))
    assert curve.low[1] == pytest.approx(0.75 ** math.exp(half), rel=1e-5)


def test_area_under_the_survival_curve_is_the_restricted_mean():
    time_s = TIMES_S
    curve = survival(time_s, time_s < 600.0, 600.0)
    area = float(np.sum(np.diff(curve.time_s) * curve.share[:-1]))
    assert area == pytest.approx(time_s.mean())


def test_missions_that_never_finish_stay_at_one():
    curve = survival(np.array([20.0, 20.0]), np.array([False, False]), 20.0)
    assert (curve.time_s[0], curve.time_s[-1]) == (0.0, 20.0)
    assert set(curve.share.tolist()) == {1.0}


def test_course_of_two_missions_is_the_mean_of_their_steps():
    course = mean_course([(1.0, 3.0), (2.0,)], 4.0, generator())
    at = [int(np.searchsorted(course.time_s, time_s)) for time_s in (0.5, 1.5, 2.5, 4.0)]
    assert course.mean[at].tolist() == [0.0, 0.5, 1.0, 1.5]
    # Resamples are both missions once, or one of them twice.
    assert course.low[at].tolist() == [0.0, 0.0, 1.0, 1.0]
    assert course.high[at].tolist() == [0.0, 1.0, 1.0, 2.0]


def test_course_of_one_mission_has_no_interval():
    course = mean_course([()], 4.0, generator())
    assert not course.mean.any()
    assert np.isnan(course.low).all()
