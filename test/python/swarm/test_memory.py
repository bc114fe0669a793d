import math

import pytest
from scipy.special import binom

from robotteamsim.swarm import memory_coefficients, memory_term


def test_published_memory_equals_the_hand_calculation():
    # a = 0.6: 0.6, 0.6/2, 0.6*0.4/6, 0.6*0.4*1.4/24
    assert memory_coefficients("published", 0.6, 4) == pytest.approx((0.6, 0.3, 0.04, 0.014))


def test_grunwald_letnikov_memory_equals_the_hand_calculation():
    # a = 0.6: 0.6, 0.6*0.4/2, 0.6*0.4*1.4/6, 0.6*0.4*1.4*2.4/24
    assert memory_coefficients("grunwald_letnikov", 0.6, 4) == pytest.approx((0.6, 0.12, 0.056, 0.0336))


@pytest.mark.parametrize("alpha", [0.0, 0.1, 0.5, 0.632, 1.0])
def test_grunwald_letnikov_coefficients_are_signed_binomials(alpha):
    expected = [(-1) ** (k + 1) * binom(alpha, k) for k in range(1, 13)]
    assert memory_coefficients("grunwald_letnikov", alpha, 12) == pytest.approx(expected)


def test_published_coefficients_sum_to_one_at_the_known_stability_bound():
    assert sum(memory_coefficients("published", 0.632, 4)) == pytest.approx(1.0, abs=1e-3)


def test_grunwald_letnikov_coefficients_never_sum_to_more_than_one():
    sums = [sum(memory_coefficients("grunwald_letnikov", 0.5, terms)) for terms in (1, 4, 100, 10_000)]
    assert sums == sorted(sums)
    assert sums[-1] == pytest.approx(1.0, abs=0.01)
    assert sums[-1] < 1.0


def test_order_one_remembers_the_last_velocity_alone():
    assert memory_coefficients("grunwald_letnikov", 1.0, 5) == (1.0, 0.0, 0.0, 0.0, 0.0)


def test_truncation_keeps_the_first_terms():
    for mode in ("published", "grunwald_letnikov"):
        assert memory_coefficients(mode, 0.4, 2) == memory_coefficients(mode, 0.4, 4)[:2]


@pytest.mark.parametrize(
    ("mode", "alpha", "terms", "message"),
    [
        ("published", 0.5, 5, "the published memory has 4 terms, got 5"),
        ("grunwald_letnikov", 0.5, 0, "at least 1 term, got 0"),
        ("published", 1.5, 4, r"alpha must lie in \[0, 1\], got 1.5"),
        ("published", math.nan, 4, r"alpha must lie in \[0, 1\], got nan"),
    ],
)
def test_wrong_memory_is_rejected(mode, alpha, terms, message):
    with pytest.raises(ValueError, match=message):
        memory_coefficients(mode, alpha, terms)


def test_memory_term_weighs_the_newest_velocity_first():
    assert memory_term((0.6, 0.3), [(1.0, 0.0), (0.0, 2.0)]) == pytest.approx((0.6, 0.6))


def test_velocities_before_the_first_count_as_zero():
    assert memory_term((0.6, 0.3, 0.04), [(1.0, -1.0)]) == pytest.approx((0.6, -0.6))
    assert memory_term((0.6,), []) == (0.0, 0.0)


def test_memory_term_of_an_invalid_velocity_is_rejected():
    with pytest.raises(TypeError, match="incompatible function arguments"):
        memory_term((0.6, 0.3), [(1.0, 0.0), (1.0, 0.0, 2.0)])
