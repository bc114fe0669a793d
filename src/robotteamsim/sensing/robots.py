"""The sensors of all robots: laser, odometry, contact and further sensors."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotteamsim.hazards import HazardSource
from robotteamsim.rng import stream
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.sensing.further import FurtherSensors
from robotteamsim.sensing.laser import Laser
from robotteamsim.sensing.odometry import TeamOdometry
from robotteamsim.sensing.readings import ROW_LENGTH, TeamReadings
from robotteamsim.sensing.smoke import SmokyAir
from robotteamsim.sensing.team_reader import make_reader
from robotteamsim.world.contract import AnyWorld


class RobotSensors:
    """The sensors of all robots of a world.

    Random streams: ("odometry", id), ("laser", id), and those of `FurtherSensors`.

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
        self._scan_shapes = [(len(robot_ids), laser.num_beams) for laser, robot_ids in self._lasers]
        self._has_laser_noise = any(model.noise_m > 0.0 for model in models)
        self._air = None if hazards is None else SmokyAir(world, hazards)
        self._further = FurtherSensors(world, robots, seed, self._air)
        self.reset()

    def read(self) -> TeamReadings:
        """Return the reading of every robot after the last step of the world, in id order.

        Odometry adds the motion of that step, so call this once after each step.
        """
        if self._world.arrivals is not self._arrivals:
            self._restart_arrived()
        rows = np.empty((len(self._robots), ROW_LENGTH))
        scans_m = [np.empty(shape, dtype=np.float32) for shape in self._scan_shapes]
        self._reader(self._odometry.next_noise(), self._laser_noise_m(), rows, scans_m)
        if self._air is not None:
            for (laser, robot_ids), scan_m in zip(self._lasers, scans_m, strict=True):
                self._air.dim(laser, robot_ids, scan_m)
        further = self._further.read() if self._further.has_any else ()
        return TeamReadings(rows, self._by_robot(scans_m), self._world.contact_angles_rad(), further)

    def _laser_noise_m(self) -> list[np.ndarray]:
        """Draw the noise of each kind of laser; empty where no laser has any."""
        if not self._has_laser_noise:
            return []
        kinds = zip(self._lasers, self._laser_streams, strict=True)
        return [laser.noise_m(streams) for (laser, _), streams in kinds]

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
        self._reader = make_reader(self._world, self._odometry, self._lasers)

    def _restart_arrived(self) -> None:
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
