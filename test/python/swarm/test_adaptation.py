import numpy as np
import pytest

from robotteamsim.swarm.context import (
    EXACT_LEVELS,
    PUBLISHED_LEVELS,
    Context,
    Levels,
    adapted_coefficients,
    membership,
)


def context(activity=0.0, socialisation=0.0, avoidance=0.0, proximity=1.0, connectivity=1.0):
    """Return the context of one robot: at rest, unsocial, clear of obstacles, near to its neighbour, connected."""
    return Context(activity, socialisation, avoidance, proximity, connectivity)


@pytest.mark.parametrize(
    ("of", "alpha", "c1", "c2", "c3", "c4"),
    [
        (context(), 0.9, 0.4, 1.6, 0.0, 0.0),
        (context(activity=1.0), 0.3, 0.4, 1.6, 0.0, 0.0),
        (context(socialisation=1.0), 0.9, 1.4, 0.6, 0.0, 0.0),
        # c_T = 2 - 0.8 - 0.2 = 1, 3/10 of it c2
        (context(avoidance=1.0), 0.6, 0.7, 0.3, 0.8, 0.2),
        (context(proximity=0.0), 0.6, 0.7, 0.3, 0.2, 0.8),
        (context(connectivity=0.0), 0.6, 0.7, 0.3, 0.2, 0.8),
        # c_T = 2 - 0.8 - 0.8; alpha is nominal though the swarm is active
        (context(activity=1.0, avoidance=1.0, proximity=0.0), 0.6, 0.28, 0.12, 0.8, 0.8),
    ],
)
def test_crisp_rules_equal_the_hand_calculation(of, alpha, c1, c2, c3, c4):
    assert adapted_coefficients("crisp", of, EXACT_LEVELS) == pytest.approx((alpha, c1, c2, c3, c4))


def test_bell_is_one_at_its_centre_one_half_at_its_width_and_falls_with_the_fourth_power():
    assert membership(1.0, 1.0) == 1.0
    assert membership(0.75, 1.0) == 0.5
    assert membership(0.5, 1.0) == pytest.approx(1 / 17)
    assert membership(0.0, 1.0) == pytest.approx(1 / 257)


def test_fuzzy_rules_halfway_to_an_obstacle_equal_the_hand_calculation():
    # close 1/2, far, not connected, active and social 1/257 each
    low = 1 / 257
    alpha = 0.5 * 0.6 + 0.5 * (low * 0.3 + (1 - low) * 0.9)
    c3 = 0.5 * 0.8 + 0.5 * low * 0.2
    c4 = low * 0.8 + (1 - low) * 0.5 * 0.2
    c_t = 2 - c3 - c4
    c2 = (0.5 * 0.3 + 0.5 * 0.8) * c_t
    found = adapted_coefficients("fuzzy", context(avoidance=0.75), EXACT_LEVELS)
    assert found == pytest.approx((alpha, c_t - c2, c2, c3, c4))


@pytest.mark.parametrize("kind", ["crisp", "fuzzy"])
def test_coefficients_always_sum_to_two_within_their_levels(kind):
    generator = np.random.default_rng(1)
    for _ in range(1000):
        alpha, *weights = adapted_coefficients(kind, Context(*generator.random(5).tolist()), PUBLISHED_LEVELS)
        assert sum(weights) == pytest.approx(2.0)
        assert min(weights) >= 0.0
        assert 0.2 <= alpha <= 0.6


def test_fuzzy_alpha_falls_steadily_with_activity_and_crisp_in_one_step():
    activities = np.linspace(0.0, 1.0, 41)
    fuzzy = [adapted_coefficients("fuzzy", context(activity=a), EXACT_LEVELS).alpha for a in activities]
    crisp = [adapted_coefficients("crisp", context(activity=a), EXACT_LEVELS).alpha for a in activities]
    assert (np.diff(fuzzy) < 0.0).all()
    assert np.count_nonzero(np.diff(crisp)) == 1


def test_levels_out_of_order_or_range_are_rejected():
    with pytest.raises(ValueError, match=r"levels of alpha must rise within \[0, 1\], got \(0.9, 0.6, 0.9\)"):
        Levels(alpha_small=0.9)
    with pytest.raises(ValueError, match=r"levels of c must rise within \[0, 1\], got \(0.2, 1.2\)"):
        Levels(c_large=1.2)
    with pytest.raises(ValueError, match=r"levels of c2_share must rise within \[0, 1\], got \(nan, 0.8\)"):
        Levels(c2_share_small=float("nan"))
