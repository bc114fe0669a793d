"""The sensors of all robots: laser, odometry, contact and additional sensors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from robotteamsim.hazards import HazardSource
from robotteamsim.rng import stream
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.sensing.beams import Laser, SmokyAir
from robotteamsim.sensing.carried import CarriedSensors
from robotteamsim.sensing.odometry import TeamOdometry
from robotteamsim.sensing.readings import TeamReadings
from robotteamsim.world.contract import AnyWorld


class Sensors(Protocol):
    """The sensors of a team."""

    def read(self) -> TeamReadings:
        """Return the reading of every robot after the last step of the world, in id order; once after each step."""


class RobotSensors:
    """The sensors of all robots of a world.

    Random streams: ("odometry", id), ("laser", id), and those of `CarriedSensors`.

    When a robot arrives, its sensors restart. From the second arrival on, the names of its streams end with the number
    of the arrival, so that its noise does not depend on what happened before.
    """

    def __init__(
        self, world: AnyWorld, robots: Sequence[PlacedRobot], seed: int, hazards: HazardSource | None = None
    ) -> None:
        """Args: robots: those of the world, in id order.  hazards: None if nothing can burn."""
        self._world = world
        self._robots = tuple(robots)
        self._seed = seed
        models = dict.fromkeys(robot.laser for robot in self._robots)
        self._lasers = [
            (Laser(model, world), [robot_id for robot_id, robot in enumerate(self._robots) if robot.laser == model])
            for model in models
        ]
        self._air = None if hazards is None else SmokyAir(hazards)
        self._carried = CarriedSensors(world, robots, seed, self._air)
        self.reset()

    def read(self) -> TeamReadings:
        """Return the reading of every robot after the last step of the world, in id order.

        Odometry adds the motion of that step, so call this once after each step.
        """
        if self._world.arrivals != self._arrivals:
            self._restart_arrived()
        state = self._odometry.read_team(self._world.team())
        kinds = zip(self._lasers, self._laser_streams, strict=True)
        scans_m = [laser.scan(robot_ids, streams) for (laser, robot_ids), streams in kinds]
        if self._air is not None:
            for (laser, robot_ids), scan_m in zip(self._lasers, scans_m, strict=True):
                self._air.dim(laser.beams, robot_ids, scan_m)
        for scan_m in scans_m:
            scan_m.flags.writeable = False  # a controller that changed it would change the record
        return TeamReadings(state, self._by_robot(scans_m), self._world.contact_angles_rad(), self._carried.read())

    def _by_robot(self, scans_m: Sequence[np.ndarray]) -> Sequence[np.ndarray] | np.ndarray:
        """Return the scans in the order of robots. Args: scans_m: per kind of laser, in the order of its robots."""
        if len(scans_m) == 1:
            return scans_m[0]
        scan_of = {
            robot_id: scan_m
            for (_, robot_ids), scans in zip(self._lasers, scans_m, strict=True)
            for robot_id, scan_m in zip(robot_ids, scans, strict=True)
        }
        return [scan_of[robot_id] for robot_id in range(len(self._robots))]

    def reset(self) -> None:
        """Restart after `World.reset`: odometry at its origin, all random streams from their start."""
        self._arrivals = self._world.arrivals
        self._carried.reset()
        self._laser_streams = [
            [stream(self._seed, "laser", robot_id) for robot_id in robot_ids] for _, robot_ids in self._lasers
        ]
        self._odometry = TeamOdometry(
            [robot.odometry for robot in self._robots],
            self._world.step_ns * 1e-9,
            [stream(self._seed, "odometry", robot_id) for robot_id in range(len(self._robots))],
            [robot.drive.kind == "omni" for robot in self._robots],
        )

    def _restart_arrived(self) -> None:
        arrivals = self._world.arrivals
        for robot_id, (before, now) in enumerate(zip(self._arrivals, arrivals, strict=True)):
            if before != now:
                again = (now,) if now > 1 else ()
                self._odometry.restart(robot_id, stream(self._seed, "odometry", robot_id, *again))
                for (_, robot_ids), streams in zip(self._lasers, self._laser_streams, strict=True):
                    if robot_id in robot_ids:
                        streams[robot_ids.index(robot_id)] = stream(self._seed, "laser", robot_id, *again)
                self._carried.restart(robot_id, again)
        self._arrivals = arrivals
