"""The targets of all motors of a team for the speeds of its drives."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from robotteamsim.scenario.drives import CarDrive
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.world.mujoco.wheels import Chassis, motor_gains, steering_rad


class Motors:
    """The motors of the robots that are present, in the order of the model's actuators."""

    def __init__(self, robots: Sequence[PlacedRobot], present: Sequence[int]) -> None:
        gains = [motor_gains(robots[robot_id]) for robot_id in present]
        self._robot_of = np.array([i for i, some in zip(present, gains, strict=True) for _ in some], dtype=int)
        self._gains = np.array([row for some in gains for row in some]).reshape(-1, 5)
        self._wheelbase_m = np.array([r.drive.wheelbase_m if isinstance(r.drive, CarDrive) else 1.0 for r in robots])
        self._track_m = np.array([Chassis.of(robot).track_m for robot in robots])

    def drive(self, data: mujoco.MjData, speeds: np.ndarray) -> None:
        """Set the targets. Args: speeds: of all drives, shape (n, 4): forward, turn, left, steering."""
        left_rad, right_rad = steering_rad(speeds[:, 3], self._wheelbase_m, self._track_m)
        wanted = np.column_stack((speeds[:, :3], left_rad, right_rad))
        data.ctrl[:] = (self._gains * wanted[self._robot_of]).sum(axis=1)
