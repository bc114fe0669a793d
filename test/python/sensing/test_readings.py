"""Readings of a team as arrays and one by one."""

from __future__ import annotations

import numpy as np
import pytest

from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.sensing.readings import NOTHING_FURTHER, OdometryReading, RobotReading, TeamReadings


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
    assert [type(part) for part in readings[1]][:3] == [PoseReading, Twist, OdometryReading]
    truth, twist, measured, ranges_m, *rest = readings[1]
    assert (truth, twist) == ((0.1, 0.2, 0.6, 0.8), (0.25, 0.0, 0.0))
    assert (type(measured.pose), type(measured.twist)) == (PoseReading, Twist)
    assert [x for part in measured for x in part] == odometry[1].tolist()
    assert [len(part) for part in measured] == [4, 3, 6, 3]
    assert ranges_m.shape == (3,)
    assert rest == [True, (0.5,), NOTHING_FURTHER]
    assert len(list(readings)) == 2
    assert isinstance(readings[0], RobotReading)


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
