"""All that robots perceive of the world by themselves: laser, odometry, contact."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotteamsim.rng import stream
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.sensing.further import FurtherSensors
from robotteamsim.sensing.laser import Laser
from robotteamsim.sensing.odometry import TeamOdometry
from robotteamsim.sensing.readings import TeamReadings
from robotteamsim.world import World


class RobotSensors:
    """The sensors of all robots of a world. Random streams: ("odometry", id), ("laser", id); `FurtherSensors`' own."""

    def __init__(self, world: World, robots: Sequence[PlacedRobot], seed: int) -> None:
        """Args: robots: those that the world was built with, in id order."""
        self._world = world
        self._robots = tuple(robots)
        self._seed = seed
        models = dict.fromkeys(robot.laser for robot in self._robots)
        self._lasers = [
            (Laser(model, world), [robot_id for robot_id, robot in enumerate(self._robots) if robot.laser == model])
            for model in models
        ]
        self._further = FurtherSensors(world, robots, seed)
        self.reset()

    def read(self) -> TeamReadings:
        """Return every robot's reading after the step that the world made last, in id order.

        Odometry adds that step's motion, so this is called once after each step.
        """
        core = self._world.core
        twists = core.twists()
        ranges_m: list[np.ndarray] = [np.empty(0)] * len(self._robots)
        for laser, robot_ids in self._lasers:
            scans = laser.scan(robot_ids, [self._laser_streams[robot_id] for robot_id in robot_ids])
            for robot_id, scan in zip(robot_ids, scans, strict=True):
                ranges_m[robot_id] = scan
        return TeamReadings(
            ground_truth=core.pose_readings(),
            twists=twists,
            odometry=self._odometry.step(core.motions(), twists),
            ranges_m=ranges_m,
            in_contact=core.in_contact(),
            contact_angles_rad=self._world.contact_angles_rad(),
            further=self._further.read(),
        )

    def reset(self) -> None:
        """Begin again as new, after `World.reset`: odometry at its origin, all random streams from their start."""
        self._further.reset()
        ids = range(len(self._robots))
        self._laser_streams = [stream(self._seed, "laser", robot_id) for robot_id in ids]
        self._odometry = TeamOdometry(
            [robot.odometry for robot in self._robots],
            self._world.step_ns * 1e-9,
            [stream(self._seed, "odometry", robot_id) for robot_id in ids],
        )
