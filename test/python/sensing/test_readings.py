"""Readings of a team as arrays and one by one."""

from __future__ import annotations

import numpy as np
import pytest

from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.sensing.readings import NOTHING_FURTHER, RobotReading, TeamReadings


def test_readings_one_by_one_hold_the_rows_of_the_arrays():
    rows = np.arange(48.0).reshape(2, 24)
    rows[0, 23] = 0.0
    readings = TeamReadings(rows, np.zeros((2, 3), np.float32), {1: (0.5,)})
    reading = readings[1]
    assert reading.ground_truth == PoseReading(24.0, 25.0, 26.0, 27.0)
    assert reading.twist == Twist(28.0, 29.0, 30.0)
    assert reading.odometry.pose == PoseReading(31.0, 32.0, 33.0, 34.0)
    assert reading.odometry.twist == Twist(35.0, 36.0, 37.0)
    assert reading.odometry.pose_covariance == (38.0, 39.0, 40.0, 41.0, 42.0, 43.0)
    assert reading.odometry.twist_variances == (44.0, 45.0, 46.0)
    assert reading.ranges_m.shape == (3,)
    assert (reading.in_contact, reading.contact_angles_rad, reading.further) == (True, (0.5,), NOTHING_FURTHER)
    assert (readings[0].in_contact, readings[0].contact_angles_rad) == (False, ())
    assert len(list(readings)) == 2
    parts = (reading.ground_truth, reading.twist, reading.odometry, reading.ranges_m, reading.in_contact)
    assert np.array_equal(RobotReading.of(*parts).row[:23], rows[1, :23])


def test_arrays_without_a_row_per_robot_are_refused():
    readings = TeamReadings(np.zeros((1, 24)), np.zeros((2, 3), np.float32))
    with pytest.raises(ValueError, match="1 rows, 2 scans"):
        list(readings)
