from __future__ import annotations

import pytest

from robotteamsim.campaign.summary import Spread, spread, summarise


def test_interval_is_students():
    # By hand: mean 3, variance 2.5, t(0.975, 4) = 2.7764451, half width 2.7764451 * sqrt(2.5 / 5).
    found = spread([1.0, 2.0, 3.0, 4.0, 5.0])
    assert (found.mean, found.sd) == (3.0, pytest.approx(2.5**0.5))
    assert (found.low, found.high) == (pytest.approx(3.0 - 1.9632432), pytest.approx(3.0 + 1.9632432))


def test_single_value_has_no_spread():
    assert spread([7.0]) == Spread(7.0, None, None, None)
    with pytest.raises(ValueError, match="values must not be empty"):
        spread([])


def test_failed_trials_count_but_have_no_figures(short_design, outcome_of, failed_outcome_of):
    design = short_design("voice.noise_db=10,20")
    trials = list(design.all_trials())
    outcomes = [outcome_of(trials[0], time_s=1.0), failed_outcome_of(trials[2]), failed_outcome_of(trials[1])]
    first, second = summarise(design, outcomes)
    assert first.settings == {"voice.noise_db": 10.0}
    assert (first.trials, first.failed, first.statistics["time_s"].mean) == (1, 1, 1.0)
    assert (second.trials, second.failed, second.statistics) == (0, 1, {})
