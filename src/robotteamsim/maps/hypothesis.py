"""One place where a robot may be."""

from __future__ import annotations

import math
from collections import deque

import msgspec
import numpy as np

from robotteamsim import _core
from robotteamsim.geometry import Pose
from robotteamsim.interface import Estimate
from robotteamsim.scenario.sections import Odometry

_SAME_RAD = 0.3
"""Poses that differ less in heading may be one place [rad]."""

_FEWEST_BEAMS = 50
"""So many informative beams are needed for a verdict."""


def are_one_place(pose: Pose, other: Pose, within_m: float) -> bool:
    """Whether two poses are the same but for errors."""
    apart = pose.inverse() @ other
    return math.hypot(apart.x_m, apart.y_m) < within_m and abs(apart.yaw_rad) < _SAME_RAD


class Agreement:
    """The fraction of informative beams that contradicted the map over the last metres driven.

    A beam is informative if it hit something, or should have.
    """

    def __init__(self, window_m: float) -> None:
        self._window_m = window_m
        self._scans: deque[tuple[float, int, int]] = deque()
        self._informative = self._contradicting = 0
        self._driven_m = 0.0

    def add(self, driven_m: float, informative: int, contradicting: int) -> None:
        """Add a scan. Args: driven_m: since the last one [m]."""
        self._driven_m += driven_m
        self._scans.append((self._driven_m, informative, contradicting))
        self._informative += informative
        self._contradicting += contradicting
        while self._scans[0][0] < self._driven_m - self._window_m:
            _, before, contradicted = self._scans.popleft()
            self._informative -= before
            self._contradicting -= contradicted

    @property
    def contradicting(self) -> float:
        """The fraction; 0 with too few informative beams for a verdict."""
        return self._contradicting / self._informative if self._informative >= _FEWEST_BEAMS else 0.0

    def is_known_over(self, length_m: float) -> bool:
        """Whether there are enough informative beams for a verdict, over a length driven [m]."""
        return self._informative >= _FEWEST_BEAMS and self._driven_m >= length_m


class Hypothesis:
    """Particles around a place where a robot may be, and how its scans agree with the map there.

    weighed:   the estimate as of the last scan.
    sightings: how many scans showed a teammate where it says that it is, minus those that showed that it is not there.
    """

    def __init__(self, particles: _core.maps.ParticleFilter, window_m: float) -> None:
        self._particles, self.agreement = particles, Agreement(window_m)
        self.sightings = 0
        self.weighed = _estimate(particles)
        self._since = Pose(0.0, 0.0, 0.0)

    @property
    def pose(self) -> Pose:
        """The pose now: that of the last scan, and odometry since then."""
        return self.weighed.pose @ self._since

    @property
    def estimate(self) -> Estimate:
        """The pose now, with the covariance as of the last scan."""
        return msgspec.structs.replace(self.weighed, pose=self.pose)

    def move(self, motion: Pose, odometry: Odometry, step_s: float, omni: bool, noise: np.ndarray) -> None:
        """Follow a step of odometry, see `_core.maps.ParticleFilter`."""
        alphas = odometry.alpha1, odometry.alpha2, odometry.alpha3, odometry.alpha4
        self._particles.move(motion, alphas, step_s, omni, noise)
        self._since = self._since @ motion

    def weigh(self, ranges_m: np.ndarray, beams: np.ndarray, draw: float) -> None:
        """Weigh the particles by beams of a scan. Args: draw: a random number from 0 to below 1."""
        self._particles.weigh(ranges_m, beams)
        self.weighed = _estimate(self._particles)
        self._particles.resample(draw)
        self._since = Pose(0.0, 0.0, 0.0)

    def shift(self, by_m: tuple[float, float]) -> None:
        """Follow a change of level."""
        self._particles.shift(by_m)
        self.weighed = msgspec.structs.replace(self.weighed, pose=Pose(*by_m, 0.0) @ self.weighed.pose)

    def particles(self, count: int) -> list[Pose]:
        """Return so many of the particles, drawn by their weights: each is as likely as any other."""
        return self._particles.drawn(count, 0.5)

    def is_at(self, pose: Pose, within_m: float) -> bool:
        """Whether a pose is this place."""
        return are_one_place(self.pose, pose, within_m)


def _estimate(particles: _core.maps.ParticleFilter) -> Estimate:
    pose, covariance = particles.mean()
    return Estimate(pose, tuple(covariance))
