"""Where a robot believes that it is."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

from robotteamsim.geometry import Pose
from robotteamsim.interface import Estimate, Localisation, Observation
from robotteamsim.maps.teammates import Disc
from robotteamsim.scenario.levels import Level, level_at
from robotteamsim.setup import Setup

_CARRIED_M = 1.0
"""No robot drives that far in a step."""


class Localiser(Protocol):
    """Follows the pose of one robot.

    looks: whether it needs to know where teammates are, because it compares what the laser sees with a map.
    """

    looks: bool

    def pose(self, observation: Observation, teammates: Sequence[Disc] = ()) -> Pose:
        """Return the pose in `map` in a step; called once in each, with what the robot measured.

        Args: teammates: where they may be; beams that end there hit no wall.
        """

    @property
    def localisation(self) -> Localisation:
        """What it knows as of the last step; its pose is the one that `pose` has returned."""

    @property
    def particles(self) -> tuple[Pose, ...]:
        """Poses for display, each as likely as any other; none if it does not follow its pose with particles."""


class TruePose:
    """The true pose: `control.localisation: ground_truth`."""

    looks = False
    particles = ()

    def pose(self, observation: Observation, teammates: Sequence[Disc] = ()) -> Pose:
        """Return the pose in a step."""
        self._pose = observation.robot.true_pose
        return self._pose

    @property
    def localisation(self) -> Localisation:
        """The true pose, which is exact."""
        return Localisation("tracking", (Estimate(self._pose),))


class LevelChanges:
    """How far stairs, a ramp or a lift take a robot, which knows it."""

    def __init__(self, robot_id: int, setup: Setup) -> None:
        self._levels, self._before = setup.scenario.plan.levels, Pose(*setup.robots[robot_id].start_pose)

    def shift_m(self, observation: Observation) -> tuple[float, float] | None:
        """Return the shift in `map` by a change of level since the last step [m]; None without one."""
        if not self._levels:
            return None
        now, before = observation.robot.true_pose, self._before
        self._before = now
        shift_m = now.x_m - before.x_m, now.y_m - before.y_m
        changed = math.hypot(*shift_m) > _CARRIED_M and self._level_at(now) is not self._level_at(before)
        return shift_m if changed else None

    def _level_at(self, pose: Pose) -> Level | None:
        return level_at(self._levels, (pose.x_m, pose.y_m))


class DeadReckoning:
    """The known start and the odometry, which nothing corrects: `control.localisation: odometry`."""

    looks = False
    particles = ()

    def __init__(self, robot_id: int, setup: Setup) -> None:
        self._map_T_odom = Pose(*setup.robots[robot_id].start_pose)
        self._levels = LevelChanges(robot_id, setup)

    def pose(self, observation: Observation, teammates: Sequence[Disc] = ()) -> Pose:
        """Return the pose in a step."""
        if (shift_m := self._levels.shift_m(observation)) is not None:
            self._map_T_odom = Pose(*shift_m, 0.0) @ self._map_T_odom
        self._odometry = observation.robot.odometry
        return self._map_T_odom @ self._odometry.pose.pose

    @property
    def localisation(self) -> Localisation:
        """The pose, with the covariance that the odometry states: it knows nothing by which it could be lost."""
        pose = self._map_T_odom @ self._odometry.pose.pose
        covariance = turned(self._odometry.pose_covariance, self._map_T_odom.yaw_rad)
        return Localisation("tracking", (Estimate(pose, covariance),))


def turned(covariance: Sequence[float], by_rad: float) -> tuple[float, ...]:
    """Return the covariance of a pose in a frame in which the axes of its own frame have this yaw.

    Args: covariance: as in `Estimate`.
    """
    xx, xy, x_yaw, yy, y_yaw, yaw_yaw = covariance
    cos, sin = math.cos(by_rad), math.sin(by_rad)
    return (
        cos * cos * xx - 2.0 * cos * sin * xy + sin * sin * yy,
        cos * sin * (xx - yy) + (cos * cos - sin * sin) * xy,
        cos * x_yaw - sin * y_yaw,
        sin * sin * xx + 2.0 * cos * sin * xy + cos * cos * yy,
        sin * x_yaw + cos * y_yaw,
        yaw_yaw,
    )
