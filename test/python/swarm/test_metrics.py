import pytest

from robotteamsim.swarm import (
    robot_avoidance,
    robot_proximity_by_distance,
    robot_proximity_by_signal,
    robot_socialisation,
    swarm_activity,
    swarm_connectivity,
)


def test_swarm_activity_is_the_speed_of_the_centre_of_mass():
    assert swarm_activity([(0.3, 0.0), (0.0, 0.4), (0.0, 0.0)], 0.5) == pytest.approx(1 / 3)
    assert swarm_activity([(0.5, 0.0)] * 4, 0.5) == 1.0


def test_robots_that_move_against_each_other_make_no_active_swarm():
    assert swarm_activity([(0.5, 0.1), (-0.5, -0.1)], 0.5) == 0.0


def test_activity_of_nobody_is_rejected():
    with pytest.raises(ValueError, match="without robots"):
        swarm_activity([], 0.5)
    with pytest.raises(ValueError, match="max_speed must be > 0, got 0"):
        swarm_activity([(1.0, 0.0)], 0)


def test_robot_socialisation_is_one_at_the_global_best_and_zero_for_the_farthest():
    positions = [(0.0, 0.0), (1.0, 0.0), (4.0, 0.0)]
    assert [robot_socialisation(p, (0.0, 0.0), positions) for p in positions] == [1.0, 0.75, 0.0]


def test_robots_that_are_all_at_the_global_best_are_social():
    assert robot_socialisation((1.0, 1.0), (1.0, 1.0), [(1.0, 1.0), (1.0, 1.0)]) == 1.0


@pytest.mark.parametrize(("clearance_m", "avoidance"), [(0.0, 1.0), (0.25, 0.75), (1.0, 0.0), (7.0, 0.0)])
def test_robot_avoidance_grows_towards_an_obstacle(clearance_m, avoidance):
    assert robot_avoidance(clearance_m, 1.0) == avoidance


def test_avoidance_without_a_sensing_radius_is_rejected():
    with pytest.raises(ValueError, match="sensing_radius_m must be > 0"):
        robot_avoidance(1.0, 0.0)


@pytest.mark.parametrize(("distance_m", "proximity"), [(0.0, 1.0), (5.0, 0.8), (25.0, 0.0), (99.0, 0.0)])
def test_proximity_by_distance_falls_to_zero_at_the_range(distance_m, proximity):
    assert robot_proximity_by_distance(distance_m, 25.0) == pytest.approx(proximity)


@pytest.mark.parametrize(
    ("signal_dbm", "proximity"),
    [(-30.0, 1.0), (-47.4, 1.0), (-70.7, 0.5), (-94.0, 0.0), (-120.0, 0.0)],
)
def test_proximity_by_signal_lies_between_the_weakest_link_and_one_metre(signal_dbm, proximity):
    assert robot_proximity_by_signal(signal_dbm, -94.0, -47.4) == pytest.approx(proximity)


def test_proximity_by_signal_needs_room_between_its_ends():
    with pytest.raises(ValueError, match=r"-94.0 dBm, must be above the minimum, -80.0 dBm"):
        robot_proximity_by_signal(-70.0, -80.0, -94.0)


def test_connectivity_of_a_complete_graph_is_one_and_of_a_split_one_zero():
    assert swarm_connectivity(5.0, 5) == 1.0
    # a chain of three: lambda_2 = 1
    assert swarm_connectivity(1.0, 3) == pytest.approx(1 / 3)
    assert swarm_connectivity(0.0, 3) == swarm_connectivity(-1e-12, 3) == 0.0
    assert swarm_connectivity(0.0, 1) == 1.0


def test_connectivity_of_nobody_is_rejected():
    with pytest.raises(ValueError, match="swarm of 0 robots"):
        swarm_connectivity(0.0, 0)
