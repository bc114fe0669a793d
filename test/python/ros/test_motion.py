from __future__ import annotations

import math

import numpy as np
import pytest

from robotteamsim.ros.nodes.motion import StepMotion


def _odometry(*yaws_rad: float) -> np.ndarray:
    rows = np.zeros((len(yaws_rad), 16))
    rows[:, 2] = [math.sin(0.5 * yaw_rad) for yaw_rad in yaws_rad]
    rows[:, 3] = [math.cos(0.5 * yaw_rad) for yaw_rad in yaws_rad]
    return rows


def test_turn_through_half_a_turn_goes_the_shorter_way() -> None:
    motion = StepMotion()
    motion.add(_odometry(math.pi - 0.1), (1,))
    assert not motion.is_known
    motion.add(-_odometry(math.pi + 0.1), (1,))  # the negative quaternion is the same rotation
    _, _, sin, cos = motion.at(0.5)[0, :4]
    assert (abs(sin), cos) == (pytest.approx(1.0), pytest.approx(0.0, abs=1e-9))


def test_robot_that_has_just_arrived_does_not_slide_to_its_start() -> None:
    motion = StepMotion()
    motion.add(_odometry(0.0, 0.0), (1, 0))
    here = _odometry(0.0, 0.0)
    here[:, 0] = 4.0
    motion.add(here, (1, 1))
    assert motion.at(0.25)[:, 0].tolist() == [1.0, 4.0]
