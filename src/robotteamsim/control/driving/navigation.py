"""Driving to a point: along the known map, around obstacles that the laser sees, and out of jams."""

from typing import Literal

from robotteamsim import _core
from robotteamsim.scenario.controllers.driving import NavigatorTuning
from robotteamsim.scenario.sections import Laser, Robot


class Navigator(_core.control.Navigator):
    """Drives one robot to a goal that may change in any step. `src/cpp/control/navigator.cpp` describes how.

    `drive` returns the command of a step. Its arguments are the grid of the known map, the robot's pose, the ranges of
    its laser, the goal in `map` [m] (one inside an obstacle is replaced by the nearest reachable point), the limit of
    the speed, the stamp of the observation, and a function that returns the last known positions of other robots, as
    `_core.control.Places` in `map` [m], which is called if the robot is stuck.
    """

    def __init__(self, body: Robot, robot_id: int, mode: Literal["path", "straight"], tuning: NavigatorTuning) -> None:
        super().__init__(
            robot_id=robot_id,
            radius_m=body.reach_m,
            laser=laser_layout(body.laser),
            max_speed_mps=body.drive.max_speed_mps,
            max_turn_radps=body.drive.max_turn_radps,
            is_car=body.drive.kind == "car",
            by_path=mode == "path",
            parameters=_core.control.NavigatorParameters(**tuning.model_dump()),
        )


def laser_layout(laser: Laser) -> _core.control.LaserLayout:
    """Return the layout of a laser's beams for the C++ library."""
    return _core.control.LaserLayout(
        beams=laser.beams,
        angle_min_rad=laser.angle_min_rad,
        angle_max_rad=laser.angle_max_rad,
        forward_m=laser.forward_m,
        range_max_m=laser.range_max_m,
        left_m=laser.left_m,
    )
