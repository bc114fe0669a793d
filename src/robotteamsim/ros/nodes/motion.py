"""Odometry between two steps, for clients that need it at the rate of the clock."""

from __future__ import annotations

import numpy as np


class StepMotion:
    """The odometry of a team during one step: its end is known when the step begins, because the world is ahead."""

    def __init__(self) -> None:
        """Start without a step."""
        self._before: np.ndarray | None = None
        self._after: np.ndarray | None = None
        self._arrivals: tuple[int, ...] = ()

    def clear(self) -> None:
        """Forget the last step, because the next one does not continue it."""
        self._before = self._after = None

    def add(self, odometry: np.ndarray, arrivals: tuple[int, ...]) -> None:
        """Take the odometry at the end of the next step.

        Args: odometry: as `TeamReadings.odometry`: float64, shape (n, 16), x, y, z and w of the quaternion first.
              arrivals: as `World.arrivals`; a robot that has just arrived stays at the end of its step.
        """
        self._before, self._after = self._after, odometry.copy()
        if self._before is not None:
            new = np.array(arrivals) != np.array(self._arrivals)
            self._before[new] = self._after[new]
        self._arrivals = arrivals

    @property
    def is_known(self) -> bool:
        """Whether the step has a beginning: the first one has none."""
        return self._before is not None

    def at(self, share: float) -> np.ndarray:
        """Return the odometry after a share of the step, 0 .. 1: poses in between, all else as at its end."""
        assert self._before is not None
        assert self._after is not None
        odometry = self._after.copy()
        before, after = self._before[:, :4], self._after[:, :4].copy()
        # A quaternion and its negative are the same rotation: interpolate along the shorter turn.
        after[np.sum(before[:, 2:] * after[:, 2:], axis=1) < 0.0, 2:] *= -1.0
        poses = (1.0 - share) * before + share * after
        poses[:, 2:] /= np.maximum(np.hypot(poses[:, 2], poses[:, 3]), 1e-12)[:, None]
        odometry[:, :4] = poses
        return odometry
