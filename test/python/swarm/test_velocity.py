import math

import numpy as np
import pytest

from robotteamsim.swarm import Attractors, Weights, limit_speed, next_position, next_velocity


class FixedNumbers:
    """A generator whose numbers are known."""

    def __init__(self, *numbers: float) -> None:
        self._numbers = np.array(numbers)

    def random(self, size: int) -> np.ndarray:
        assert size == len(self._numbers)
        return self._numbers


ATTRACTORS = Attractors(local_best=(2.0, 1.0), global_best=(5.0, 1.0), obstacle=(1.0, 0.0), communication=(1.0, -9.0))


def test_velocity_update_by_hand():
    # v = (0.1, 0.2) + 0.8*0.5*(1, 0) + 0.1*1*(4, 0) + 0.2*0.5*(0, -1) + 0.4*0.25*(0, -10)
    velocity = next_velocity(
        (1.0, 1.0), (0.1, 0.2), ATTRACTORS, Weights(0.8, 0.1, 0.2, 0.4), FixedNumbers(0.5, 1.0, 0.5, 0.25)
    )
    assert velocity == pytest.approx((0.9, -0.9))


def test_robot_at_all_its_attractors_keeps_only_its_memory():
    here = (3.0, 4.0)
    velocity = next_velocity(
        here, (0.3, -0.1), Attractors(here, here, here, here), Weights(1, 1, 1, 1), np.random.default_rng(0)
    )
    assert velocity == (0.3, -0.1)


def test_weight_of_zero_leaves_the_numbers_of_the_others():
    full = next_velocity((1.0, 1.0), (0, 0), ATTRACTORS, Weights(1, 0, 0, 1), np.random.default_rng(5))
    part = next_velocity((1.0, 1.0), (0, 0), ATTRACTORS, Weights(1, 0, 0, 0), np.random.default_rng(5))
    assert full[0] == part[0]
    assert full[1] < part[1]


def test_mean_velocity_uses_half_of_each_weight():
    rng = np.random.default_rng(1)
    velocities = [next_velocity((1.0, 1.0), (0, 0), ATTRACTORS, Weights(0.8, 0.1, 0, 0), rng) for _ in range(20_000)]
    assert np.mean(velocities, axis=0) == pytest.approx((0.5 * (0.8 * 1 + 0.1 * 4), 0.0), abs=0.01)


def test_speed_limit_keeps_the_direction():
    assert limit_speed((3.0, 4.0), 1.0) == pytest.approx((0.6, 0.8))
    assert math.hypot(*limit_speed((1e-3, -7.0), 0.58)) == pytest.approx(0.58)


def test_slow_velocity_is_left_as_it_is():
    assert limit_speed((0.3, 0.4), 0.5) == (0.3, 0.4)
    assert limit_speed((0.0, 0.0), 0.5) == (0.0, 0.0)


def test_position_moves_by_the_velocity():
    assert next_position((1.0, 2.0), (0.5, -0.25)) == (1.5, 1.75)
