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
    """The sensors of all robots of a world. Random streams: ("odometry", id), ("laser", id); `FurtherSensors`' own.

    With a robot that comes (again) its sensors begin anew; from the second time on that number ends the names of its
    streams, so nothing that it draws depends on what was before.
    """

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
        if self._world.arrivals is not self._arrivals:
            self._begin_for_those_who_came()
        ground_truth, positions_m, twists, in_contact, contact_angles_rad = self._world.core.readings()
        return TeamReadings(
            ground_truth=ground_truth,
            positions_m=positions_m,
            twists=twists,
            odometry=self._odometry.follow(self._world),
            ranges_m=self._scan(),
            in_contact=in_contact,
            contact_angles_rad=contact_angles_rad,
            further=self._further.read(),
        )

    def reset(self) -> None:
        """Begin again as new, after `World.reset`: odometry at its origin, all random streams from their start."""
        self._arrivals = self._world.arrivals
        self._further.reset()
        self._laser_streams = [
            [stream(self._seed, "laser", robot_id) for robot_id in robot_ids] for _, robot_ids in self._lasers
        ]
        self._odometry = TeamOdometry(
            [robot.odometry for robot in self._robots],
            self._world.step_ns * 1e-9,
            [stream(self._seed, "odometry", robot_id) for robot_id in range(len(self._robots))],
            [robot.drive.kind == "omni" for robot in self._robots],
        )

    def _begin_for_those_who_came(self) -> None:
        arrivals = self._world.arrivals
        for robot_id, (before, now) in enumerate(zip(self._arrivals, arrivals, strict=True)):
            if before != now:
                again = (now,) if now > 1 else ()
                self._odometry.restart(robot_id, stream(self._seed, "odometry", robot_id, *again))
                for (_, robot_ids), streams in zip(self._lasers, self._laser_streams, strict=True):
                    if robot_id in robot_ids:
                        streams[robot_ids.index(robot_id)] = stream(self._seed, "laser", robot_id, *again)
                self._further.restart(robot_id, again)
        self._arrivals = arrivals

    def _scan(self) -> Sequence[np.ndarray] | np.ndarray:
        """Return the scan of every robot, in id order; of robots of one kind as one array."""
        scans = [
            laser.scan(robot_ids, streams)
            for (laser, robot_ids), streams in zip(self._lasers, self._laser_streams, strict=True)
        ]
        if len(scans) == 1:
            return scans[0]
        ranges_m: list[np.ndarray] = [np.empty(0)] * len(self._robots)
        for (_, robot_ids), team_scans in zip(self._lasers, scans, strict=True):
            for robot_id, scan in zip(robot_ids, team_scans, strict=True):
                ranges_m[robot_id] = scan
        return ranges_m
