"""The readings of a robot's sensors in one step, in the form in which ROS messages carry them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

import msgspec
import numpy as np

from robotteamsim import _core
from robotteamsim.geometry import Pose, PoseReading, Twist


class OdometryReading(msgspec.Struct, frozen=True):
    """A pose in `odom` and the twist in `base_link` that the wheels measured.

    pose_covariance: of x, y [m] and yaw [rad], the upper triangle row by row: xx, xy, x yaw, yy, y yaw, yaw yaw.
    twist_variances: of the speeds forward and to the left [m^2/s^2] and of the turn [rad^2/s^2]; to the left it is 0
                     unless the robot is omnidirectional.
    """

    pose: PoseReading
    twist: Twist
    pose_covariance: tuple[float, ...] = (0.0,) * 6
    twist_variances: tuple[float, ...] = (0.0,) * 3


class VoiceReading(msgspec.Struct, frozen=True):
    """What a robot hears.

    level_db:            voice level at the robot [dB]; 0 where no voice is above the noise.
    heard:               whether any cell within the local-best radius is above the noise.
    local_best_m:        centre of the loudest cell within the radius, in `map` [m]; the robot itself if not heard.
    local_best_level_db: its level [dB]; 0 if not heard.
    """

    level_db: float
    heard: bool
    local_best_m: tuple[float, float]
    local_best_level_db: float


NOTHING_SENSED: Mapping[str, Any] = MappingProxyType({})
"""The readings of additional sensors in a step in which none of a robot's measured."""


class RobotReading(msgspec.Struct, frozen=True, eq=False):
    """What one robot measures in one step.

    ground_truth: the true pose in `map`; NaN for an absent robot, whose other readings mean nothing.
    twist:        the true velocity in `base_link`.
    odometry:     the pose and the velocity that the wheels measured.
    ranges_m:     float32, shape (beams,), first beam at angle_min; no return as the scenario defines it.
    in_contact:   whether the robot touches something.
    contact_angles_rad: directions of contacts from base_link, ascending in (-pi, pi].
    sensors:      readings of `robots.sensors` that measured in this step, by their names; see `scenario.sensors`.
    """

    ground_truth: PoseReading
    twist: Twist
    odometry: OdometryReading
    ranges_m: np.ndarray
    in_contact: bool
    contact_angles_rad: tuple[float, ...] = ()
    sensors: Mapping[str, Any] = NOTHING_SENSED

    @property
    def true_pose(self) -> Pose:
        """The true pose in `map` with its yaw in (-pi, pi]."""
        return self.ground_truth.pose


def state_of(robots: Sequence[RobotReading], voices: Sequence[VoiceReading] = ()) -> _core.state.State:
    """Return the state of a mission whose robots measure and hear this, wherever they do.

    Raises: ValueError: there are more voices than robots.
    """
    state = _core.state.State(len(robots), max((len(robot.ranges_m) for robot in robots), default=0))
    for robot_id, robot in enumerate(robots):
        state.put_reading(robot_id, robot)
    for robot_id, voice in enumerate(voices):
        state.put_voice(robot_id, voice)
    return state
