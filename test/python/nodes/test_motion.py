from __future__ import annotations

import math

import numpy as np
import pytest

from robotteamsim.nodes.motion import StepMotion, TeamOdometry


def _odometry(*yaws_rad: float, x_m: float = 0.0, sign: float = 1.0) -> TeamOdometry:
    """Return the odometry of robots with these headings. Args: sign: of the quaternions."""
    n = len(yaws_rad)
    pose = [(x_m, 0.0, sign * math.sin(0.5 * yaw_rad), sign * math.cos(0.5 * yaw_rad)) for yaw_rad in yaws_rad]
    return TeamOdometry(
        pose=np.array(pose),
        twist=np.zeros((n, 3)),
        pose_covariance=np.zeros((n, 6)),
        twist_variances=np.zeros((n, 3)),
    )


def test_turn_takes_the_shorter_direction() -> None:
    motion = StepMotion()
    motion.add(_odometry(math.pi - 0.1), (1,))
    assert not motion.is_known
    motion.add(_odometry(math.pi + 0.1, sign=-1.0), (1,))  # the negative quaternion is the same rotation
    _, _, sin, cos = motion.at(0.5).pose[0]
    assert (abs(sin), cos) == (pytest.approx(1.0), pytest.approx(0.0, abs=1e-9))


def test_robot_that_has_just_arrived_does_not_slide_to_its_start() -> None:
    motion = StepMotion()
    motion.add(_odometry(0.0, 0.0), (1, 0))
    motion.add(_odometry(0.0, 0.0, x_m=4.0), (1, 1))
    assert motion.at(0.25).pose.tolist() == [[1.0, 0.0, 0.0, 1.0], [4.0, 0.0, 0.0, 1.0]]
