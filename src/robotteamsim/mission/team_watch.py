"""What becomes of the team's swarms and controllers, told from the robots' decisions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from operator import attrgetter

from robotteamsim.control.controller import OUTSIDE, Decision

_WATCHED = attrgetter("excluded", "swarm", "fault")


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
    swarm together may do so in different steps. The base belongs to no swarm.
    """

    def __init__(self, base: int | None = None) -> None:
        self._base = base
        self._told: list[tuple[bool, int, str]] = []
        self._swarms: list[int] = []
        self._faults: list[str] = []

    @property
    def all_excluded(self) -> bool:
        """Whether no robot belongs to a swarm."""
        return bool(self._swarms) and self._swarms.count(OUTSIDE) == len(self._swarms)

    def changes(self, decisions: Sequence[Decision]) -> list[Change]:
        """Return what has changed since the last step, in id order; a swarm's end follows after who left it."""
        told = list(map(_WATCHED, decisions))
        if told == self._told:
            return []
        self._told = told
        swarms = [OUTSIDE if decision.excluded else decision.swarm for decision in decisions]
        faults = [decision.fault for decision in decisions]
        if self._base is not None:
            swarms[self._base] = OUTSIDE
        before = self._swarms or [OUTSIDE if i == self._base else max(swarm, 0) for i, swarm in enumerate(swarms)]
        found = [*_changes_of_swarms(before, swarms), *_new_faults(self._faults or [""] * len(faults), faults)]
        self._swarms, self._faults = swarms, faults
        return found


def _changes_of_swarms(before: list[int], now: list[int]) -> Iterator[Change]:
    there, left = set(before) - {OUTSIDE}, set(now) - {OUTSIDE}
    for robot_id, (old, new) in enumerate(zip(before, now, strict=True)):
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
