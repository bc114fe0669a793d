"""Odometry between two steps, for clients that need it at the rate of the clock."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from robotteamsim import _core
from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.sensing.readings import OdometryReading


class TeamOdometry(NamedTuple):
    """The odometry of a team at one time: arrays in the forms of `OdometryReading`, one row per robot."""

    pose: np.ndarray
    twist: np.ndarray
    pose_covariance: np.ndarray
    twist_variances: np.ndarray

    @classmethod
    def of(cls, state: _core.state.State) -> TeamOdometry:
        """Return the odometry at the end of a step."""
        rows = state.odometry_pose, state.odometry_twist
        return cls(*rows, state.odometry_pose_covariance, state.odometry_twist_variances)

    def readings(self) -> list[OdometryReading]:
        """Return the odometry of each robot."""
        return [
            OdometryReading(PoseReading(*pose), Twist(*twist), tuple(covariance), tuple(variances))
            for pose, twist, covariance, variances in zip(*(rows.tolist() for rows in self), strict=True)
        ]


class StepMotion:
    """The odometry of a team during one step: its end is known when the step begins, because the world is ahead."""

    def __init__(self) -> None:
        """Start without a step."""
        self._before: TeamOdometry | None = None
        self._after: TeamOdometry | None = None
        self._arrivals: tuple[int, ...] = ()
        self._has_come = np.zeros(0, dtype=bool)

    def clear(self) -> None:
        """Forget the last step, because the next one does not continue it."""
        self._before = self._after = None

    def add(self, odometry: TeamOdometry, arrivals: tuple[int, ...]) -> None:
        """Take the odometry at the end of the next step.

        Args: arrivals: as `World.arrivals`; a robot that has just arrived stays at the end of its step.
        """
        self._before, self._after = self._after, odometry
        self._has_come = np.array(arrivals) != np.array(self._arrivals or arrivals)
        self._arrivals = arrivals

    @property
    def is_known(self) -> bool:
        """Whether the step has a beginning: the first one has none."""
        return self._before is not None

    def at(self, share: float) -> TeamOdometry:
        """Return the odometry after a share of the step, 0 .. 1: poses in between, all else as at its end."""
        assert self._before is not None
        assert self._after is not None
        after = self._after.pose.copy()
        before = np.where(self._has_come[:, None], after, self._before.pose)
        # A quaternion and its negative are the same rotation: interpolate along the shorter turn.
        after[np.sum(before[:, 2:] * after[:, 2:], axis=1) < 0.0, 2:] *= -1.0
        poses = (1.0 - share) * before + share * after
        poses[:, 2:] /= np.maximum(np.hypot(poses[:, 2], poses[:, 3]), 1e-12)[:, None]
        return self._after._replace(pose=poses)
