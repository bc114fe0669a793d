"""Readings of a team as arrays and one by one."""

from __future__ import annotations

import numpy as np
import pytest
from robotteamsim._core.sensing import OdometryState, TeamState

from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.sensing.readings import TeamReadings


def team(n: int = 2) -> TeamState:
    """Return a state in which no two numbers are equal."""

    def numbers(first: float, columns: int) -> np.ndarray:
        return first + np.arange(float(n * columns)).reshape(n, columns)

    odometry = OdometryState(
        pose=numbers(200.0, 4),
        twist=numbers(300.0, 3),
        pose_covariance=numbers(400.0, 6),
        twist_variances=numbers(500.0, 3),
    )
    contact = np.arange(n) % 2 == 1
    return TeamState(true_pose=numbers(0.0, 4), true_twist=numbers(100.0, 3), odometry=odometry, contact=contact)


def test_record_of_a_robot_has_the_rows_of_the_arrays():
    readings = TeamReadings(team(), np.zeros((2, 3), np.float32), {1: (0.5,)})
    reading = readings[1]
    assert reading.ground_truth == PoseReading(4.0, 5.0, 6.0, 7.0)
    assert reading.twist == Twist(103.0, 104.0, 105.0)
    assert reading.odometry.pose == PoseReading(204.0, 205.0, 206.0, 207.0)
    assert reading.odometry.twist == Twist(303.0, 304.0, 305.0)
    assert reading.odometry.pose_covariance == (406.0, 407.0, 408.0, 409.0, 410.0, 411.0)
    assert reading.odometry.twist_variances == (503.0, 504.0, 505.0)
    assert reading.ranges_m.shape == (3,)
    assert (reading.in_contact, reading.contact_angles_rad, reading.sensors) == (True, (0.5,), {})
    assert (readings[0].in_contact, readings[0].contact_angles_rad) == (False, ())
    assert len(list(readings)) == 2


def test_arrays_made_of_records_are_the_arrays_of_which_the_records_were_made():
    readings = TeamReadings(team(), np.zeros((2, 3), np.float32), {1: (0.5,)})
    again = TeamReadings.of(readings)
    assert np.array_equal(again.state.true_pose, readings.state.true_pose)
    assert np.array_equal(again.state.true_twist, readings.state.true_twist)
    assert np.array_equal(again.state.contact, readings.state.contact)
    for name in ("pose", "twist", "pose_covariance", "twist_variances"):
        assert np.array_equal(getattr(again.state.odometry, name), getattr(readings.state.odometry, name))
    assert again.contact_angles_rad == readings.contact_angles_rad


def test_arrays_of_a_state_outlive_it_and_cannot_be_changed():
    pose = team().odometry.pose
    assert pose[1].tolist() == [204.0, 205.0, 206.0, 207.0]
    with pytest.raises(ValueError, match="read-only"):
        pose[0] = 0.0


def test_arrays_without_a_row_per_robot_are_rejected():
    readings = TeamReadings(team(1), np.zeros((2, 3), np.float32))
    with pytest.raises(ValueError, match="one item per robot"):
        list(readings)
    state = team()
    with pytest.raises(ValueError, match="one row per robot"):
        TeamState(
            true_pose=state.true_pose, true_twist=state.true_twist[:1], odometry=state.odometry, contact=state.contact
        )
