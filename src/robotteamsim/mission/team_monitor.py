"""Events of the team's swarms and controllers, derived from the robots' decisions."""

from collections.abc import Collection, Iterator, Sequence
from operator import attrgetter

import numpy as np

from robotteamsim.interface import OUTSIDE, Decision
from robotteamsim.mission.events import (
    ControllerFailed,
    Happening,
    RobotExcluded,
    RobotIncluded,
    SwarmDissolved,
    SwarmFounded,
)

_ABSENT = -2
"""Replaces the swarm of an absent robot."""


_STATUS = attrgetter("excluded", "swarm", "fault", "done")


class TeamMonitor:
    """Compares the decisions of each step with those of the previous one.

    A swarm consists of the robots whose decisions name it. Each robot decides for itself, so robots that leave, join or
    found a swarm together may do so in different steps. Outsiders and absent robots belong to no swarm.
    """

    def __init__(self, outsiders: Collection[int] = ()) -> None:
        """Args: outsiders: ids of the base and of the firefighters."""
        self._outsiders = outsiders
        self._statuses: list[tuple[bool, int, str, str]] = []
        """Excluded, swarm, fault and done of each robot in the last step."""
        self._is_there: list[bool] = []
        """Whether each robot was present in the last step."""
        self.all_excluded = False
        """Whether no present robot belongs to a swarm."""
        self.done = ""
        """Why the team has nothing left to do, according to its first robot; "" while any working robot has."""
        self._swarms: list[int] = []
        self._faults: list[str] = []

    def changes(self, decisions: Sequence[Decision], present: np.ndarray) -> list[Happening]:
        """Return the changes since the last step, in id order; the end of a swarm follows the robots that left it.

        Args: present: whether each robot is present, bool, shape (n,).
        """
        statuses, is_there = list(map(_STATUS, decisions)), present.tolist()
        if statuses == self._statuses and is_there == self._is_there:
            return []
        self._statuses, self._is_there = statuses, is_there
        swarms = [OUTSIDE if excluded else swarm for excluded, swarm, *_ in statuses]
        faults = [fault for *_, fault, _ in statuses]
        self.done = self._done(statuses, is_there)
        for outsider in self._outsiders:
            swarms[outsider] = OUTSIDE
        swarms = [swarm if there else _ABSENT for swarm, there in zip(swarms, is_there, strict=True)]
        before = self._swarms or self._at_first(swarms)
        found = [*_changes_of_swarms(before, swarms), *_new_faults(self._faults or [""] * len(faults), faults)]
        self._swarms, self._faults = swarms, faults
        self.all_excluded = len(swarms) > len(self._outsiders) and all(s in (OUTSIDE, _ABSENT) for s in swarms)
        return found

    def _done(self, statuses: list[tuple[bool, int, str, str]], is_there: list[bool]) -> str:
        """Return the reason of the first robot if all are done; absent, stopped robots and outsiders do not count."""
        reasons = [
            done
            for robot_id, (_, _, fault, done) in enumerate(statuses)
            if is_there[robot_id] and robot_id not in self._outsiders and not fault
        ]
        return reasons[0] if all(reasons) and reasons else ""

    def _at_first(self, swarms: list[int]) -> list[int]:
        """Return the swarms before the first step; a robot that is excluded in it was in swarm 0."""
        return [0 if swarm == OUTSIDE and i not in self._outsiders else swarm for i, swarm in enumerate(swarms)]


def _changes_of_swarms(before: list[int], now: list[int]) -> Iterator[Happening]:
    there, left = set(before) - {OUTSIDE, _ABSENT}, set(now) - {OUTSIDE, _ABSENT}
    for robot_id, (old, new) in enumerate(zip(before, now, strict=True)):
        if _ABSENT in (old, new):
            continue  # Robots that are removed or spawned have events of their own.
        if old != new and old != OUTSIDE:
            yield RobotExcluded(old, robot_id=robot_id)
        if old != new and new in there:
            yield RobotIncluded(new, robot_id=robot_id)
    for swarm in sorted(left - there):
        founders = tuple(robot_id for robot_id, new in enumerate(now) if new == swarm)
        yield SwarmFounded(swarm, founders, robot_id=founders[0])
    for swarm in sorted(there - left):
        yield SwarmDissolved(swarm)


def _new_faults(before: list[str], now: list[str]) -> Iterator[Happening]:
    for robot_id, (old, new) in enumerate(zip(before, now, strict=True)):
        if new and not old:
            yield ControllerFailed(new, robot_id=robot_id)
