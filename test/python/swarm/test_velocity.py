import math
from collections.abc import Iterator
from itertools import islice

import numpy as np
import pytest

from robotteamsim.swarm import Attractors, Weights, limit_speed, next_position, next_velocity, uniform_numbers

ATTRACTORS = Attractors(local_best=(2.0, 1.0), global_best=(5.0, 1.0), obstacle=(1.0, 0.0), communication=(1.0, -9.0))


def numbers_of(seed: int) -> Iterator[float]:
    return uniform_numbers(np.random.default_rng(seed))


def test_velocity_update_equals_the_hand_calculation():
    # v = (0.1, 0.2) + 0.8*0.5*(1, 0) + 0.1*1*(4, 0) + 0.2*0.5*(0, -1) + 0.4*0.25*(0, -10)
    velocity = next_velocity(
        (1.0, 1.0), (0.1, 0.2), ATTRACTORS, Weights(0.8, 0.1, 0.2, 0.4), iter((0.5, 1.0, 0.5, 0.25))
    )
    assert velocity == pytest.approx((0.9, -0.9))


def test_robot_at_all_its_attractors_keeps_only_its_memory():
    here = (3.0, 4.0)
    velocity = next_velocity(here, (0.3, -0.1), Attractors(here, here, here, here), Weights(1, 1, 1, 1), numbers_of(0))
    assert velocity == (0.3, -0.1)


def test_weight_of_zero_leaves_the_numbers_of_the_others():
    full = next_velocity((1.0, 1.0), (0, 0), ATTRACTORS, Weights(1, 0, 0, 1), numbers_of(5))
    part = next_velocity((1.0, 1.0), (0, 0), ATTRACTORS, Weights(1, 0, 0, 0), numbers_of(5))
    assert full[0] == part[0]
    assert full[1] < part[1]


def test_velocity_takes_four_numbers_and_leaves_the_fifth():
    numbers = iter((0.5, 1.0, 0.5, 0.25, 0.75))
    next_velocity((1.0, 1.0), (0.1, 0.2), ATTRACTORS, Weights(0.8, 0.1, 0.2, 0.4), numbers)
    assert list(numbers) == [0.75]


def test_numbers_are_those_that_the_generator_draws_four_by_four():
    four_by_four = np.random.default_rng(7)
    drawn = [number for _ in range(50) for number in four_by_four.random(4).tolist()]
    assert list(islice(numbers_of(7), 200)) == drawn


def test_mean_velocity_uses_half_of_each_weight():
    numbers = numbers_of(1)
    velocities = [
        next_velocity((1.0, 1.0), (0, 0), ATTRACTORS, Weights(0.8, 0.1, 0, 0), numbers) for _ in range(20_000)
    ]
    assert np.mean(velocities, axis=0) == pytest.approx((0.5 * (0.8 * 1 + 0.1 * 4), 0.0), abs=0.01)


def test_speed_limit_keeps_the_direction():
    assert limit_speed((3.0, 4.0), 1.0) == pytest.approx((0.6, 0.8))
    assert math.hypot(*limit_speed((1e-3, -7.0), 0.58)) == pytest.approx(0.58)


def test_slow_velocity_is_left_as_it_is():
    assert limit_speed((0.3, 0.4), 0.5) == (0.3, 0.4)
    assert limit_speed((0.0, 0.0), 0.5) == (0.0, 0.0)


def test_position_moves_by_the_velocity():
    assert next_position((1.0, 2.0), (0.5, -0.25)) == (1.5, 1.75)


def test_velocity_without_a_number_for_each_attractor_is_rejected():
    with pytest.raises(ValueError, match="a random number for each attractor"):
        next_velocity((1.0, 1.0), (0.0, 0.0), ATTRACTORS, Weights(1, 1, 1, 1), iter((0.5, 0.5, 0.5)))


@pytest.mark.parametrize(
    ("attractors", "weights", "numbers"),
    [
        (ATTRACTORS[:3], (1.0,) * 4, iter((0.5,) * 4)),
        (ATTRACTORS, (1.0,) * 3, iter((0.5,) * 4)),
        (((1.0,),) * 4, (1.0,) * 4, iter((0.5,) * 4)),
        (ATTRACTORS, (1.0,) * 4, iter("abcd")),
    ],
)
def test_velocity_of_invalid_attractors_weights_or_numbers_is_rejected(attractors, weights, numbers):
    with pytest.raises(TypeError, match="incompatible function arguments"):
        next_velocity((1.0, 1.0), (0.0, 0.0), attractors, weights, numbers)
