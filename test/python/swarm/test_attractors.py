import pytest

from robotteamsim.swarm import communication_attractor, communication_weight


def test_communication_attractor_is_one_range_from_the_neighbour():
    assert communication_attractor((10.0, 0.0), (0.0, 0.0), 25.0) == (25.0, 0.0)
    assert communication_attractor((30.0, 40.0), (0.0, 0.0), 25.0) == pytest.approx((15.0, 20.0))


def test_robot_on_its_neighbour_stays():
    assert communication_attractor((1.0, 2.0), (1.0, 2.0), 25.0) == (1.0, 2.0)


@pytest.mark.parametrize(
    ("proximity", "weight"), [(1.0, 0.0), (0.5, 0.0), (0.3, 0.0), (0.15, 0.2), (0.03, 0.36), (0.0, 0.4)]
)
def test_communication_weight_grows_from_the_endangered_to_the_lost_link(proximity, weight):
    assert communication_weight(0.4, proximity, 0.3, connected=True) == pytest.approx(weight)


def test_communication_weight_is_full_in_a_split_swarm():
    assert communication_weight(0.4, 1.0, 0.3, connected=False) == 0.4
