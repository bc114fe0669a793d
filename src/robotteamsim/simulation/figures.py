"""Per-robot figures of a trial, gathered step by step."""

from __future__ import annotations

import math
from collections.abc import Sequence

from robotteamsim.simulation.record import RobotFigures

_STAY_RADIUS_M = 0.5


class TeamFigures:
    """Adds up what each robot does."""

    def __init__(self, num_robots: int, step_s: float) -> None:
        self._logs = [_RobotLog() for _ in range(num_robots)]
        self._step_s = step_s

    def update(
        self,
        positions_m: Sequence[tuple[float, float]],
        in_contact: Sequence[bool],
        excluded: Sequence[bool],
        running: bool,
    ) -> None:
        """Take in one step, in id order. Staying counts only while the mission runs.

        Args: positions_m: true ones, in `map` [m]; NaN of a robot that is not there, of whom nothing counts.
        """
        for log, position_m, touches, is_excluded in zip(self._logs, positions_m, in_contact, excluded, strict=True):
            if math.isnan(position_m[0]):
                log.leave()
                continue
            log.move(position_m, running)
            log.contact_steps += touches
            log.excluded_steps += is_excluded

    def result(self) -> tuple[RobotFigures, ...]:
        """Return the figures so far, in id order."""
        return tuple(
            RobotFigures(
                distance_m=log.distance_m,
                contact_s=log.contact_steps * self._step_s,
                excluded_s=log.excluded_steps * self._step_s,
                longest_stay_s=log.longest_stay_steps * self._step_s,
            )
            for log in self._logs
        )


class _RobotLog:
    """The sums of one robot."""

    def __init__(self) -> None:
        self.distance_m = 0.0
        self.contact_steps = self.excluded_steps = self.stay_steps = self.longest_stay_steps = 0
        self._last_m: tuple[float, float] | None = None
        self._anchor_m = (math.inf, math.inf)

    def leave(self) -> None:
        """Take note that the robot is not there: it comes again without a way from where it was."""
        self._last_m, self._anchor_m = None, (math.inf, math.inf)

    def move(self, position_m: tuple[float, float], running: bool) -> None:
        """Take in where the robot is."""
        if self._last_m is not None:
            self.distance_m += math.dist(position_m, self._last_m)
        self._last_m = position_m
        if math.dist(position_m, self._anchor_m) > _STAY_RADIUS_M:
            self._anchor_m, self.stay_steps = position_m, 0
        if running:
            self.stay_steps += 1
            if self.stay_steps > self.longest_stay_steps:
                self.longest_stay_steps = self.stay_steps
