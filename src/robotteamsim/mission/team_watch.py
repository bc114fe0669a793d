"""What becomes of the team's swarms and controllers, told from the robots' decisions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from operator import itemgetter

import numpy as np

from robotteamsim.interface import OUTSIDE, Decision

# By index, as names of a tuple's items take several times as long.
_WATCHED = itemgetter(*[Decision._fields.index(name) for name in ("excluded", "swarm", "fault")])

_ABSENT = -2
"""In place of its swarm: the robot is not there."""


@dataclass(frozen=True, slots=True)
class Change:
    """One event of the team; see `mission.status.Event`."""

    kind: str
    subject: str
    robot_id: int
    detail: str


class TeamWatch:
    """Compares each step's decisions with those of the step before.

    Swarms are known by who says to belong to them; each robot decides for itself, so those who leave, join or found a
    swarm together may do so in different steps. The base belongs to no swarm, and neither does who is not there.
    """

    def __init__(self, base: int | None = None) -> None:
        self._base = base
        self._told: list[tuple[bool, int, str]] = []
        self._present: np.ndarray | None = None
        self.all_excluded = False
        """Whether no robot that is there belongs to a swarm."""
        self._swarms: list[int] = []
        self._faults: list[str] = []

    def changes(self, decisions: Sequence[Decision], present: np.ndarray | None = None) -> list[Change]:
        """Return what has changed since the last step, in id order; a swarm's end follows after who left it.

        Args: present: whether each robot is there, bool, shape (n,); None: all are.
        """
        told = list(map(_WATCHED, decisions))
        if told == self._told and present is self._present:
            return []
        self._told, self._present = told, present
        swarms = [OUTSIDE if decision.excluded else decision.swarm for decision in decisions]
        faults = [decision.fault for decision in decisions]
        if self._base is not None:
            swarms[self._base] = OUTSIDE
        if present is not None:
            swarms = [swarm if there else _ABSENT for swarm, there in zip(swarms, present.tolist(), strict=True)]
        before = self._swarms or self._at_first(swarms)
        found = [*_changes_of_swarms(before, swarms), *_new_faults(self._faults or [""] * len(faults), faults)]
        self._swarms, self._faults = swarms, faults
        self.all_excluded = all(swarm in (OUTSIDE, _ABSENT) for swarm in swarms)
        return found

    def _at_first(self, swarms: list[int]) -> list[int]:
        """Return who belonged where before the first step: who is excluded in it has been in the first swarm."""
        return [0 if swarm == OUTSIDE and i != self._base else swarm for i, swarm in enumerate(swarms)]


def _changes_of_swarms(before: list[int], now: list[int]) -> Iterator[Change]:
    there, left = set(before) - {OUTSIDE, _ABSENT}, set(now) - {OUTSIDE, _ABSENT}
    for robot_id, (old, new) in enumerate(zip(before, now, strict=True)):
        if _ABSENT in (old, new):
            continue  # Who leaves is not excluded, and who comes not taken in: it is told otherwise.
        if old != new and old != OUTSIDE:
            yield Change("robot_excluded", _name(old), robot_id, f"robot {robot_id} is excluded from {_name(old)}")
        if old != new and new in there:
            yield Change("robot_included", _name(new), robot_id, f"robot {robot_id} is taken into {_name(new)}")
    for swarm in sorted(left - there):
        founders = [str(robot_id) for robot_id, new in enumerate(now) if new == swarm]
        who = f"robot{'s' if len(founders) > 1 else ''} {', '.join(founders)}"
        yield Change("swarm_founded", _name(swarm), int(founders[0]), f"{_name(swarm)} is founded by {who}")
    for swarm in sorted(there - left):
        yield Change("swarm_dissolved", _name(swarm), -1, f"{_name(swarm)} is dissolved")


def _new_faults(before: list[str], now: list[str]) -> Iterator[Change]:
    for robot_id, (old, new) in enumerate(zip(before, now, strict=True)):
        if new and not old:
            yield Change("controller_failed", "", robot_id, f"robot {robot_id} is stopped: {new}")


def _name(swarm: int) -> str:
    return f"swarm {swarm}"
