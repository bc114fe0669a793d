"""Where a robot believes that it is."""

from __future__ import annotations

import math
from typing import Protocol

from robotteamsim.geometry import Pose
from robotteamsim.interface import Observation
from robotteamsim.scenario.levels import Level, level_at
from robotteamsim.setup import Setup

_CARRIED_M = 1.0
"""No robot drives that far in a step."""


class Localiser(Protocol):
    """Follows the pose of one robot."""

    def pose(self, observation: Observation) -> Pose:
        """Return the pose in `map` in a step; called once in each, with what the robot measured."""


class DeadReckoning:
    """The known start and the odometry, which nothing corrects: `control.localisation: odometry`.

    A robot that stairs, a ramp or a lift have taken to another level knows by how far.
    """

    def __init__(self, robot_id: int, setup: Setup) -> None:
        self._map_T_odom = self._before = Pose(*setup.robots[robot_id].start_pose)
        self._levels = setup.scenario.plan.levels

    def pose(self, observation: Observation) -> Pose:
        """Return the pose in a step."""
        robot = observation.robot
        if self._levels:
            now, before = robot.true_pose, self._before
            shift_m = now.x_m - before.x_m, now.y_m - before.y_m
            if math.hypot(*shift_m) > _CARRIED_M and self._level_at(now) is not self._level_at(before):
                self._map_T_odom = Pose(*shift_m, 0.0) @ self._map_T_odom
            self._before = now
        return self._map_T_odom @ robot.odometry.pose.pose

    def _level_at(self, pose: Pose) -> Level | None:
        return level_at(self._levels, (pose.x_m, pose.y_m))
