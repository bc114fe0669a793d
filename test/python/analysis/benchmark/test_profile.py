"""Performance profiles by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robotteamsim.analysis.benchmark.profile import profiles

INF = math.inf


def test_profile_of_three_problems():
    # Ratios: quick 1, 1, 3; slow 2, 4, 1.
    found = profiles({"quick": np.array([10.0, 5.0, 30.0]), "slow": np.array([20.0, 20.0, 10.0])})
    assert [found["quick"].at(ratio) for ratio in (0.5, 1.0, 2.9, 3.0)] == pytest.approx([0.0, 2 / 3, 2 / 3, 1.0])
    assert [found["slow"].at(ratio) for ratio in (1.0, 2.0, 3.9, 4.0)] == pytest.approx([1 / 3, 2 / 3, 2 / 3, 1.0])


def test_unsolved_problems_count_against_all_and_never_for_anyone():
    found = profiles({"a": np.array([1.0, INF, INF]), "b": np.array([INF, 2.0, INF])})
    assert found["a"].at(1e9) == found["b"].at(1e9) == pytest.approx(1 / 3)
    found = profiles({"a": np.array([1.0]), "none": np.array([INF])})
    assert found["none"].at(1e9) == 0.0


def test_solver_that_is_never_worse_has_a_profile_that_is_never_lower():
    best, worse = np.array([1.0, 2.0, 3.0, INF]), np.array([1.5, 2.0, INF, INF])
    found = profiles({"best": best, "worse": worse})
    assert all(found["best"].at(ratio) >= found["worse"].at(ratio) for ratio in np.linspace(1.0, 5.0, 50))


@pytest.mark.parametrize("times", [{}, {"a": np.array([])}, {"a": np.array([0.0])}, {"a": np.ones(2), "b": np.ones(3)}])
def test_times_that_are_no_comparison_are_rejected(times):
    with pytest.raises(ValueError, match="times must be"):
        profiles(times)
