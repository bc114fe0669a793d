"""Totals of each robot over a trial, gathered step by step."""

from __future__ import annotations

from collections.abc import Sequence

from robotteamsim import _core
from robotteamsim.simulation.record import RobotTotals


class TeamTotals:
    """Adds up what each robot does."""

    def __init__(self, num_robots: int, step_s: float) -> None:
        self._core = _core.simulation.TeamTotals(num_robots)
        self._step_s = step_s

    def update(self, state: _core.sensing.TeamState, excluded: Sequence[bool], running: bool) -> None:
        """Add a step. A stay counts only while the mission runs.

        Args:
            state:    of the team, as in `TeamReadings`; an absent robot does not count.
            excluded: whether each robot is excluded.
            running:  whether the mission runs.
        Raises: ValueError: not one entry per robot.
        """
        self._core.add_step(state, excluded, running)

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
