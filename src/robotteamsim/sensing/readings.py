"""The readings of a robot's sensors in one step, in the form in which ROS messages carry them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from types import MappingProxyType
from typing import Any

import msgspec
import numpy as np
from msgspec.structs import astuple

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


class TeamReadings(msgspec.Struct, frozen=True, eq=False, dict=True):
    """The readings of all robots in one step, in id order: as arrays, or one record per robot.

    state:    poses, velocities, odometry and contacts of the team, as named arrays; `_core.sensing.TeamState`:

              true_pose, true_twist: in the forms of `PoseReading` and `Twist`, float64, shapes (n, 4) and (n, 3); NaN
                                     for an absent robot, whose other readings mean nothing.
              odometry: its `pose`, `twist`, `pose_covariance` and `twist_variances` in the forms of `OdometryReading`,
                        float64, shapes (n, 4), (n, 3), (n, 6) and (n, 3).
              contact:  whether each robot touches something, bool, shape (n,).
    ranges_m: float32 per robot, shape (beams,) [m].
    contact_angles_rad: of the robots that touch something, by id.
    sensors:  readings of the additional sensors that measured in this step, by robot and by their names.
    """

    state: _core.sensing.TeamState
    ranges_m: Sequence[np.ndarray] | np.ndarray
    contact_angles_rad: dict[int, tuple[float, ...]] = {}
    sensors: dict[int, Mapping[str, Any]] = {}

    @classmethod
    def of(cls, robots: Sequence[RobotReading]) -> TeamReadings:
        """Return the readings that consist of those of each robot."""
        odometry = [robot.odometry for robot in robots]
        state = _core.sensing.TeamState(
            true_pose=_rows([astuple(robot.ground_truth) for robot in robots], 4),
            true_twist=_rows([astuple(robot.twist) for robot in robots], 3),
            odometry=_core.sensing.OdometryState(
                pose=_rows([astuple(reading.pose) for reading in odometry], 4),
                twist=_rows([astuple(reading.twist) for reading in odometry], 3),
                pose_covariance=_rows([reading.pose_covariance for reading in odometry], 6),
                twist_variances=_rows([reading.twist_variances for reading in odometry], 3),
            ),
            contact=np.array([robot.in_contact for robot in robots], dtype=bool),
        )
        angles_rad = {i: robot.contact_angles_rad for i, robot in enumerate(robots) if robot.contact_angles_rad}
        sensors = {i: robot.sensors for i, robot in enumerate(robots) if robot.sensors}
        return cls(state, [robot.ranges_m for robot in robots], angles_rad, sensors)

    @property
    def positions_m(self) -> np.ndarray:
        """The true positions in `map`, C-contiguous, shape (n, 2) [m]."""
        return self.state.positions_m

    @cached_property
    def robots(self) -> Sequence[RobotReading]:
        """The readings of each robot. Raises: ValueError: the arrays have different lengths."""
        return self.state.readings(self.ranges_m, self.contact_angles_rad, self.sensors)

    def __len__(self) -> int:
        return len(self.state)

    def __getitem__(self, robot_id: int) -> RobotReading:
        return self.robots[robot_id]

    def __iter__(self) -> Iterator[RobotReading]:
        return iter(self.robots)


def _rows(records: Sequence[Sequence[float]], columns: int) -> np.ndarray:
    """Return records as rows of an array, also if there are none."""
    return np.array(records, dtype=np.float64).reshape(-1, columns)
