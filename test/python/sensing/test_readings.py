"""Readings of a team as arrays and one by one."""

from __future__ import annotations

import numpy as np
import pytest

from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.sensing.readings import NOTHING_FURTHER, TeamReadings


def test_readings_one_by_one_hold_the_rows_of_the_arrays():
    odometry = np.arange(32.0).reshape(2, 16)
    readings = TeamReadings(
        ground_truth=np.array([[1.0, 2.0, 0.0, 1.0], [0.1, 0.2, 0.6, 0.8]]),
        positions_m=np.array([[1.0, 2.0], [0.1, 0.2]]),
        twists=np.array([[0.5, 0.0, -1.0], [0.25, 0.0, 0.0]]),
        odometry=odometry,
        ranges_m=np.zeros((2, 3), np.float32),
        in_contact=np.array([False, True]),
        contact_angles_rad={1: (0.5,)},
    )
    reading = readings[1]
    assert reading.ground_truth == PoseReading(0.1, 0.2, 0.6, 0.8)
    assert reading.twist == Twist(0.25, 0.0, 0.0)
    assert reading.odometry.pose == PoseReading(16.0, 17.0, 18.0, 19.0)
    assert reading.odometry.twist == Twist(20.0, 21.0, 22.0)
    assert reading.odometry.pose_covariance == (23.0, 24.0, 25.0, 26.0, 27.0, 28.0)
    assert reading.odometry.twist_variances == (29.0, 30.0, 31.0)
    assert reading.ranges_m.shape == (3,)
    assert (reading.in_contact, reading.contact_angles_rad, reading.further) == (True, (0.5,), NOTHING_FURTHER)
    assert (readings[0].in_contact, readings[0].contact_angles_rad) == (False, ())
    assert len(list(readings)) == 2


def test_arrays_without_a_row_per_robot_are_refused():
    readings = TeamReadings(
        ground_truth=np.zeros((1, 4)),
        positions_m=np.zeros((1, 2)),
        twists=np.zeros((1, 3)),
        odometry=np.zeros((2, 16)),
        ranges_m=np.zeros((2, 3), np.float32),
        in_contact=np.zeros(2, dtype=bool),
    )
    with pytest.raises(ValueError, match="zip"):
        list(readings)
