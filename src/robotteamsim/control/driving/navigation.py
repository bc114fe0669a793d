"""Driving to a point: along the known map, around obstacles that the laser sees, and out of jams."""

from collections.abc import Callable, Mapping
from typing import Literal

import numpy as np

from robotteamsim import _core
from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario.control_tuning import NavigatorTuning
from robotteamsim.scenario.sections import Laser, Robot
from robotteamsim.swarm import Vector


class Navigator:
    """Drives one robot to a goal that may change in any step. `src/cpp/control/navigator.cpp` describes how."""

    def __init__(self, body: Robot, robot_id: int, mode: Literal["path", "straight"], tuning: NavigatorTuning) -> None:
        self._core = _core.control.Navigator(
            robot_id=robot_id,
            radius_m=body.reach_m,
            laser=laser_layout(body.laser),
            max_speed_mps=body.drive.max_speed_mps,
            max_turn_radps=body.drive.max_turn_radps,
            is_car=body.drive.kind == "car",
            by_path=mode == "path",
            parameters=_core.control.NavigatorParameters(**tuning.model_dump()),
        )

    def drive(
        self,
        grid: _core.plan.PlanningGrid,
        pose: Pose,
        ranges_m: np.ndarray,
        goal: Vector,
        speed_mps: float,
        sim_time_ns: int,
        teammates: Callable[[], Mapping[int, Vector]],
    ) -> Twist:
        """Return the command of this step.

        Args: grid: of the known map.
              goal: in `map` [m]; one inside an obstacle is replaced by the nearest reachable point.
              speed_mps: limit of the speed.  sim_time_ns: stamp of the observation.
              teammates: returns the last known positions of other robots, in `map` [m]; called if the robot is stuck.
        """
        return self._core.drive(grid, pose, ranges_m, goal, speed_mps, sim_time_ns, teammates)


def laser_layout(laser: Laser) -> _core.control.LaserLayout:
    """Return the layout of a laser's beams for the C++ library."""
    return _core.control.LaserLayout(
        beams=laser.beams,
        angle_min_rad=laser.angle_min_rad,
        angle_max_rad=laser.angle_max_rad,
        forward_m=laser.forward_m,
        range_max_m=laser.range_max_m,
    )
