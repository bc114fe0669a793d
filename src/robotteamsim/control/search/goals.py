"""Where a robot drives: to the place with the most expected victims per second of travel, or to a voice."""

from __future__ import annotations

import math
from collections.abc import Sequence

from robotteamsim import _core
from robotteamsim.control.search.cells import NO_CELL
from robotteamsim.scenario.controllers.search import SearchControl
from robotteamsim.swarm import Vector

_PROGRESS_M = 0.5
"""A path that becomes shorter by less is no progress [m]."""

_JUMP_M = 3.0
"""A path that becomes longer by more at once leads to another place: a door has closed, or a source has moved [m]."""


class Progress:
    """Watches whether a robot gets nearer to its goal."""

    def __init__(self, timeout_s: float) -> None:
        self._timeout_s = timeout_s
        self._least_m = self._last_m = math.inf
        self._since_s = 0.0

    def restart(self, time_s: float) -> None:
        """Begin with a new goal."""
        self._least_m = self._last_m = math.inf
        self._since_s = time_s

    def pause(self, for_s: float) -> None:
        """Do not count a time in which the robot waits for others."""
        self._since_s += for_s

    def is_stuck(self, length_m: float, time_s: float) -> bool:
        """Return whether the path to the goal has not become shorter for too long."""
        if length_m > self._last_m + _JUMP_M:
            self.restart(time_s)
        self._last_m = length_m
        if length_m < self._least_m - _PROGRESS_M:
            self._least_m, self._since_s = length_m, time_s
        return time_s - self._since_s > self._timeout_s


class ListeningGoal:
    """The cell at which one robot listens next.

    It stays the goal while no other place is much better. Places that turn out to be useless or out of reach are
    avoided for some time.
    """

    def __init__(self, tuning: SearchControl, speed_mps: float) -> None:
        self._tuning, self._speed_mps = tuning, speed_mps
        self._progress = Progress(tuning.progress_timeout_s)
        self._avoided: dict[int, float] = {}
        """Cells, and until when they are avoided [s]."""
        self._next_choice_s = 0.0
        self._claims: list[int] = []
        """Those at the last choice."""
        self.cell = NO_CELL
        """NO_CELL if no place is worth the time."""

    def clear(self) -> None:
        """Choose again in the next iteration, because the robot did something else meanwhile."""
        self.cell, self._next_choice_s = NO_CELL, 0.0

    def pause(self, for_s: float) -> None:
        """Do not count a time in which the robot waits for others."""
        self._progress.pause(for_s)

    def forget_avoided(self) -> None:
        """Try avoided places again, because a voice has fallen silent or a door has changed."""
        self._avoided.clear()
        self.clear()

    def avoid(self, cell: int, time_s: float) -> None:
        """Avoid a cell for some time."""
        self._avoided[cell] = time_s + self._tuning.avoided_s

    def choose(
        self,
        belief: _core.control.VictimBelief,
        paths: _core.control.CellPaths,
        start: int,
        candidates: Sequence[int],
        claims: list[int],
        prior_claims: list[int],
        least: float,
        time_s: float,
    ) -> int:
        """Return the cell to drive to; NO_CELL if no place is worth the time.

        Args: start: the cell of the robot.  claims: cells at which teammates will listen.
              prior_claims: those of them that compete with the robot's own goal.
              least: that a place must be worth, in shares of the prior per second of travel.
        """
        speed_mps, delay_s = self._speed_mps, self._tuning.delay_s
        rate = 0.0
        if self.cell != NO_CELL:
            _, _, rate = belief.worth(paths, start, self.cell, prior_claims, speed_mps, delay_s)
            stuck = self._progress.is_stuck(paths.length_m(self.cell, start), time_s)
            if rate < least or start == self.cell or stuck:
                if rate >= least:
                    self.avoid(self.cell, time_s)
                self.clear()
                rate = 0.0
        # Without a goal, a robot must not end the search before it has compared the places that teammates have left.
        if time_s >= self._next_choice_s or (self.cell == NO_CELL and claims != self._claims):
            self._claims = claims
            self._next_choice_s = time_s + self._tuning.choose_s
            self._avoided = {cell: until_s for cell, until_s in self._avoided.items() if until_s > time_s}
            if self._avoided:
                candidates = [cell for cell in candidates if cell not in self._avoided]
            best = belief.best(paths, start, candidates, claims, speed_mps, delay_s)
            if best is not None and best[2] >= least and best[2] > self._tuning.better * rate:
                self.cell = best[0]
                self._progress.restart(time_s)
        return self.cell


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

    def pause(self, for_s: float) -> None:
        """Do not count a time in which the robot waits for others."""
        self._progress.pause(for_s)
        self._until_s += for_s

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
