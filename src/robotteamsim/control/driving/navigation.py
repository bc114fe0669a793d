"""Driving to a point: along the known map, around what the laser sees, and out of jams."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Literal, Protocol

import numpy as np

from robotteamsim import _core
from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario.sections import Laser, Robot
from robotteamsim.swarm import Vector


class Drive(Protocol):
    """The way that a navigator is called."""

    def __call__(
        self,
        grid: _core.PlanningGrid,
        pose: Pose,
        ranges_m: np.ndarray,
        goal: Vector,
        speed_mps: float,
        sim_time_ns: int,
        teammates: Callable[[], Mapping[int, Vector]],
        /,
    ) -> Twist:
        """Return the command of this step.

        Args: grid: of the known map.
              goal: in `map` [m]; one inside an obstacle stands for the nearest free point that can be reached.
              speed_mps: not to be exceeded.  sim_time_ns: the observation's stamp.
              teammates: tells where other robots were last heard to be, in `map` [m]; asked where the robot is stuck.
        """


class Navigator:
    """Drives one robot to a goal that may change in any step. How is told in `src/cpp/control/navigator.cpp`."""

    def __init__(self, body: Robot, robot_id: int, mode: Literal["path", "straight"]) -> None:
        navigator = _core.Navigator(
            robot_id=robot_id,
            radius_m=body.reach_m,
            laser=laser_layout(body.laser),
            max_speed_mps=body.drive.max_speed_mps,
            max_turn_radps=body.drive.max_turn_radps,
            is_car=body.drive.kind == "car",
            by_path=mode == "path",
            twist=Twist,
        )
        # Not wrapped: every robot drives in every step.
        self.drive: Drive = navigator.drive


def laser_layout(laser: Laser) -> _core.LaserLayout:
    """Return what the library must know of a laser to read its scans."""
    return _core.LaserLayout(
        beams=laser.beams,
        angle_min_rad=laser.angle_min_rad,
        angle_max_rad=laser.angle_max_rad,
        forward_m=laser.forward_m,
        range_max_m=laser.range_max_m,
    )
