import math

import pytest

from robotteamsim.swarm import Attractors, Weights, limit_speed, next_position, next_velocity

ATTRACTORS = Attractors(local_best=(2.0, 1.0), global_best=(5.0, 1.0), obstacle=(1.0, 0.0), communication=(1.0, -9.0))


HALVES = (0.5, 0.5, 0.5, 0.5)


def test_velocity_update_equals_the_hand_calculation():
    # v = (0.1, 0.2) + 0.8*0.5*(1, 0) + 0.1*1*(4, 0) + 0.2*0.5*(0, -1) + 0.4*0.25*(0, -10)
    velocity = next_velocity((1.0, 1.0), (0.1, 0.2), ATTRACTORS, Weights(0.8, 0.1, 0.2, 0.4), (0.5, 1.0, 0.5, 0.25))
    assert velocity == pytest.approx((0.9, -0.9))


def test_robot_at_all_its_attractors_keeps_only_its_memory():
    here = (3.0, 4.0)
    velocity = next_velocity(here, (0.3, -0.1), Attractors(here, here, here, here), Weights(1, 1, 1, 1), HALVES)
    assert velocity == (0.3, -0.1)


def test_speed_limit_keeps_the_direction():
    assert limit_speed((3.0, 4.0), 1.0) == pytest.approx((0.6, 0.8))
    assert math.hypot(*limit_speed((1e-3, -7.0), 0.58)) == pytest.approx(0.58)


def test_slow_velocity_is_left_as_it_is():
    assert limit_speed((0.3, 0.4), 0.5) == (0.3, 0.4)
    assert limit_speed((0.0, 0.0), 0.5) == (0.0, 0.0)


def test_position_moves_by_the_velocity():
    assert next_position((1.0, 2.0), (0.5, -0.25)) == (1.5, 1.75)


@pytest.mark.parametrize(
    ("attractors", "weights", "numbers"),
    [
        (ATTRACTORS[:3], (1.0,) * 4, HALVES),
        (ATTRACTORS, (1.0,) * 3, HALVES),
        (((1.0,),) * 4, (1.0,) * 4, HALVES),
        (ATTRACTORS, (1.0,) * 4, HALVES[:3]),
        (ATTRACTORS, (1.0,) * 4, ("a", "b", "c", "d")),
    ],
)
def test_velocity_of_invalid_attractors_weights_or_numbers_is_rejected(attractors, weights, numbers):
    with pytest.raises(TypeError, match="incompatible function arguments"):
        next_velocity((1.0, 1.0), (0.0, 0.0), attractors, weights, numbers)
