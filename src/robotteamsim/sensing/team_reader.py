"""Reads the sensors that every robot has: the true pose and velocity, odometry, contact and laser."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Protocol

import numpy as np
from msgspec.structs import astuple

from robotteamsim import _core
from robotteamsim.sensing.beams import PlanarBeams
from robotteamsim.sensing.laser import Laser
from robotteamsim.sensing.odometry import TeamOdometry
from robotteamsim.world.contract import AnyWorld


class TeamReader(Protocol):
    """A function that reads a team after the last step of a world."""

    def __call__(
        self,
        odometry_noise: np.ndarray,
        laser_noise_m: Sequence[np.ndarray],
        readings: np.ndarray,
        ranges_m: Sequence[np.ndarray],
    ) -> None:
        """Write the readings.

        Args: laser_noise_m: per kind of laser; empty: none has any.
              readings:      to be filled in, as `TeamReadings.rows`.
              ranges_m:      to be filled in, float32 per kind of laser, shape (robots, beams).
        """


def make_reader(world: AnyWorld, odometry: TeamOdometry, lasers: Sequence[tuple[Laser, Sequence[int]]]) -> TeamReader:
    """Return the reader of a team in a world. Args: lasers: each kind with the robots that carry it."""
    scene = world.scene
    if isinstance(scene, _core.world.World):
        kinds = [(laser.beams.laser, ids) for laser, ids in lasers if isinstance(laser.beams, PlanarBeams)]
        return partial(_core.sensing.TeamSensors(odometry.core, kinds).read, scene)
    return _Reader(world, odometry, lasers)


class _Reader:
    """Reads a team with the members of the worlds' contract only."""

    def __init__(self, world: AnyWorld, odometry: TeamOdometry, lasers: Sequence[tuple[Laser, Sequence[int]]]) -> None:
        self._world = world
        self._odometry = odometry
        self._lasers = lasers

    def __call__(
        self,
        odometry_noise: np.ndarray,
        laser_noise_m: Sequence[np.ndarray],
        readings: np.ndarray,
        ranges_m: Sequence[np.ndarray],
    ) -> None:
        world = self._world
        poses, twists, motions = (
            np.array(list(map(astuple, rows))) for rows in (world.poses(), world.twists(), world.motions())
        )
        readings[:, :2] = poses[:, :2]
        readings[:, 2] = np.sin(0.5 * poses[:, 2])
        readings[:, 3] = np.cos(0.5 * poses[:, 2])
        readings[:, 4:7] = twists
        readings[:, 7:23] = self._odometry.core.step(motions, twists, odometry_noise)
        readings[:, 23] = world.in_contact()
        noise_m = laser_noise_m or [np.empty((0, 0))] * len(self._lasers)
        for (laser, robot_ids), noise, scans in zip(self._lasers, noise_m, ranges_m, strict=True):
            scans[:] = laser.beams.scan(robot_ids, noise)
