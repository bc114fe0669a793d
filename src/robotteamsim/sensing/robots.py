"""All that robots perceive of the world by themselves: laser, odometry, contact."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotteamsim import _core
from robotteamsim.rng import stream
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.sensing.further import FurtherSensors
from robotteamsim.sensing.laser import Laser
from robotteamsim.sensing.odometry import TeamOdometry
from robotteamsim.sensing.readings import ROW_LENGTH, TeamReadings
from robotteamsim.world import World


class RobotSensors:
    """The sensors of all robots of a world. Random streams: ("odometry", id), ("laser", id); `FurtherSensors`' own.

    With a robot that comes (again) its sensors begin anew; from the second time on that number ends the names of its
    streams, so nothing that it draws depends on what was before.
    """

    def __init__(self, world: World, robots: Sequence[PlacedRobot], seed: int) -> None:
        """Args: robots: those of the world, in id order."""
        self._world = world
        self._robots = tuple(robots)
        self._seed = seed
        models = dict.fromkeys(robot.laser for robot in self._robots)
        self._lasers = [
            (Laser(model, world), [robot_id for robot_id, robot in enumerate(self._robots) if robot.laser == model])
            for model in models
        ]
        self._scan_shapes = [(len(robot_ids), laser.beams) for laser, robot_ids in self._lasers]
        self._has_laser_noise = any(model.noise_m > 0.0 for model in models)
        self._further = FurtherSensors(world, robots, seed)
        self.reset()

    def read(self) -> TeamReadings:
        """Return every robot's reading after the step that the world made last, in id order.

        Odometry adds that step's motion, so this is called once after each step.
        """
        if self._world.arrivals is not self._arrivals:
            self._begin_for_those_who_came()
        rows = np.empty((len(self._robots), ROW_LENGTH))
        scans_m = [np.empty(shape, dtype=np.float32) for shape in self._scan_shapes]
        self._core.read(self._world.core, self._odometry.next_noise(), self._laser_noise_m(), rows, scans_m)
        further = self._further.read() if self._further.has_any else ()
        return TeamReadings(rows, self._by_robot(scans_m), self._world.contact_angles_rad(), further)

    def _laser_noise_m(self) -> list[np.ndarray]:
        """Draw the noise of each kind of laser; empty where no laser has any."""
        if not self._has_laser_noise:
            return []
        kinds = zip(self._lasers, self._laser_streams, strict=True)
        return [laser.noise_m(streams) for (laser, _), streams in kinds]

    def _by_robot(self, scans_m: Sequence[np.ndarray]) -> Sequence[np.ndarray] | np.ndarray:
        """Return the scans in the order of robots. Args: scans_m: of each kind of laser, in the order of its robots."""
        if len(scans_m) == 1:
            return scans_m[0]
        scan_of = {
            robot_id: scan_m
            for (_, robot_ids), scans in zip(self._lasers, scans_m, strict=True)
            for robot_id, scan_m in zip(robot_ids, scans, strict=True)
        }
        return [scan_of[robot_id] for robot_id in range(len(self._robots))]

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
        self._core = _core.sensing.TeamSensors(
            self._odometry.core, [(laser.core, robot_ids) for laser, robot_ids in self._lasers]
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
