from __future__ import annotations

import numpy as np
import pytest

from robotteamsim import rng
from study.dissertation.equivalence import equivalence, mean_ratio, median_ratio, sd_ratio
from study.dissertation.reference import dissertation_missions

TIMES_S = {noise_db: np.array([m.time_s for m in missions]) for noise_db, missions in dissertation_missions().items()}


def generator():
    return rng.stream(1, "test")


def ratio(ours, theirs):
    return equivalence((ours, theirs), mean_ratio, (0.9, 1.1), generator())


def test_two_one_sided_tests_agree_with_their_interval():
    equal = ratio(TIMES_S[10.0], TIMES_S[10.0])
    assert equal.interval.value == 1.0
    assert equal.p < 0.05
    assert 0.9 < equal.interval.low < 1.0 < equal.interval.high < 1.1
    other = ratio(TIMES_S[30.0], TIMES_S[10.0])
    assert other.interval.high < 0.9
    assert other.p > 0.99
    assert other.outside
    near = ratio(TIMES_S[10.0] * 0.92, TIMES_S[10.0])
    assert near.interval.low < 0.9 < near.interval.value
    assert 0.05 < near.p < 0.5
    assert not near.outside


def test_single_mission_shows_no_equivalence():
    for theirs in (TIMES_S[10.0], np.array([400.0])):
        single = ratio(np.array([400.0]), theirs)
        assert single.p == 1.0
        assert not single.outside


def test_ratios_of_medians_and_standard_deviations_are_those_of_the_samples():
    stretched = 100.0 + 2.0 * TIMES_S[30.0]
    assert float(median_ratio(stretched, TIMES_S[30.0], axis=-1)) == pytest.approx((100.0 + 2.0 * 339.5) / 339.5)
    assert float(sd_ratio(stretched, TIMES_S[30.0], axis=-1)) == pytest.approx(2.0)
