"""Per-robot figures of a trial, gathered step by step."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotteamsim.control.controller import Decision
from robotteamsim.sensing.readings import RobotReading
from robotteamsim.simulation.record import RobotFigures

_STAY_RADIUS_M = 0.5


class TeamFigures:
    """Adds up what each of n robots does."""

    def __init__(self, num_robots: int, step_s: float) -> None:
        self._step_s = step_s
        self._last_m: np.ndarray | None = None
        self._distance_m = np.zeros(num_robots)
        self._contact_steps = np.zeros(num_robots, dtype=np.int64)
        self._excluded_steps = np.zeros(num_robots, dtype=np.int64)
        self._anchor_m = np.full((num_robots, 2), np.inf)
        self._stay_steps = np.zeros(num_robots, dtype=np.int64)
        self._longest_stay_steps = np.zeros(num_robots, dtype=np.int64)

    def update(
        self, positions_m: np.ndarray, readings: Sequence[RobotReading], decisions: Sequence[Decision], running: bool
    ) -> None:
        """Take in one step; positions_m has shape (n, 2). Staying counts only while the mission runs."""
        if self._last_m is not None:
            self._distance_m += np.hypot(*(positions_m - self._last_m).T)
        self._last_m = positions_m
        self._contact_steps += [reading.in_contact for reading in readings]
        self._excluded_steps += [decision.excluded for decision in decisions]
        left = np.hypot(*(positions_m - self._anchor_m).T) > _STAY_RADIUS_M
        self._anchor_m[left] = positions_m[left]
        self._stay_steps[left] = 0
        if running:
            self._stay_steps += 1
            np.maximum(self._longest_stay_steps, self._stay_steps, out=self._longest_stay_steps)

    def result(self) -> tuple[RobotFigures, ...]:
        """Return the figures so far, in id order."""
        columns = (
            self._distance_m,
            self._contact_steps * self._step_s,
            self._excluded_steps * self._step_s,
            self._longest_stay_steps * self._step_s,
        )
        return tuple(RobotFigures(*row) for row in np.stack(columns, axis=1).tolist())
