"""The approach to a voice: how long it may take, and which voices a robot has given up."""

from __future__ import annotations

import math

from robotteamsim.control.search.goals import Progress
from robotteamsim.scenario.controllers.search import SearchControl
from robotteamsim.swarm import Vector

_MOVED_M = 2.0
"""If the estimated source of a voice moves farther, the robot has a new goal [m]."""

_LONGEST_APPROACH = 4.0
"""A voice that was approached for longer than this, in `progress_timeout_s`, and than its path takes is given up."""


class Approach:
    """Watches whether a robot gets to the source of a voice."""

    def __init__(self, tuning: SearchControl, speed_mps: float) -> None:
        self._tuning, self._speed_mps = tuning, speed_mps
        self._progress = Progress(tuning.progress_timeout_s)
        self._source_m: Vector | None = None
        self._until_s = self._longest_m = 0.0
        self._given_up: list[tuple[Vector, float]] = []
        """Sources of voices that the robot could not reach, and until when it ignores them [s]."""
        self.path_m = 0.0
        """Length of the path to the source [m]."""
        self.lost_m: Vector | None = None
        """The source of the last voice that the robot could not reach, in `map` [m]."""

    def has_given_up(self, source_m: Vector, time_s: float) -> bool:
        """Whether the robot ignores a voice for now."""
        self._given_up = [(place, until_s) for place, until_s in self._given_up if until_s > time_s]
        return any(math.dist(place, source_m) <= self._tuning.same_voice_m for place, _ in self._given_up)

    def forget_given_up(self) -> None:
        """Ignore no voice any more."""
        self._given_up.clear()

    def goes_on(self, source_m: Vector, path_m: float, time_s: float, *, was_on: bool) -> bool:
        """Whether to approach a voice; if not, it cannot be reached now, or is given up.

        Args: path_m: infinite without a path.  was_on: whether the robot approached a voice in the last iteration.
        """
        if self._source_m is None or not was_on:
            self._until_s = time_s + _LONGEST_APPROACH * self._tuning.progress_timeout_s
            self._longest_m = 0.0
        if self._source_m is None or math.dist(self._source_m, source_m) > _MOVED_M:
            self._source_m = source_m
            self._progress.restart(time_s)
        if not math.isfinite(path_m):
            self.lost_m = source_m
            return False  # Further levels may lead to another cell.
        if self._is_stuck(path_m, time_s):
            self._given_up.append((source_m, time_s + self._tuning.avoided_s))
            self.lost_m, self._source_m = source_m, None
            return False
        self.path_m = path_m
        return True

    def _is_stuck(self, path_m: float, time_s: float) -> bool:
        """Whether the path does not become shorter, or the approach takes too long."""
        self._longest_m = max(self._longest_m, path_m)
        until_s = self._until_s + 2.0 * self._longest_m / self._speed_mps
        return self._progress.is_stuck(path_m, time_s) or time_s > until_s
