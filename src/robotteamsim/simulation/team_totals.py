"""Totals of each robot over a trial, gathered step by step."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotteamsim import _core
from robotteamsim.simulation.record import RobotTotals


class TeamTotals:
    """Adds up what each robot does."""

    def __init__(self, num_robots: int, step_s: float) -> None:
        self._core = _core.simulation.TeamTotals(num_robots)
        self._step_s = step_s

    def update(self, positions_m: np.ndarray, in_contact: np.ndarray, excluded: Sequence[bool], running: bool) -> None:
        """Add a step. A stay counts only while the mission runs.

        Args:
            positions_m: true ones, in `map` [m], float64, shape (n, 2); NaN for an absent robot, which does not count.
            in_contact:  whether each robot touches something, bool, shape (n,).
            excluded:    whether each robot is excluded.
            running:     whether the mission runs.
        Raises: ValueError: the shapes differ.
        """
        self._core.add_step(positions_m, in_contact, excluded, running)

    def result(self) -> tuple[RobotTotals, ...]:
        """Return the totals so far, in id order."""
        return tuple(
            RobotTotals(
                distance_m=robot.distance_m,
                contact_s=robot.contact_steps * self._step_s,
                excluded_s=robot.excluded_steps * self._step_s,
                longest_stay_s=robot.longest_stay_steps * self._step_s,
            )
            for robot in self._core.totals()
        )
