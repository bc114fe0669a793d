"""The state of the doors, the single source of whether a door is open or closed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal, NamedTuple

from robotteamsim.scenario.floor_plan import Door, FloorPlan
from robotteamsim.scenario.plan import Corners, door_corners, leaf_corners

LeafMotion = Literal["still", "opens", "closes", "held"]


@dataclass(frozen=True, slots=True)
class DoorState:
    """The state of a door after a step.

    closed:  whether the leaf spans the whole gap. Radio, voices and the mission use only this.
    opening: from 0 (closed) to 1 (open); 0 or 1 for a door without a moving leaf.
    motion:  of its leaf: still, opens, closes, or held (blocked by a robot or object).
    """

    closed: bool
    opening: float
    motion: LeafMotion = "still"


class DoorChange(NamedTuple):
    """A door whose state has changed."""

    name: str
    before: DoorState
    now: DoorState


class DoorStates(Mapping[str, DoorState]):
    """All doors after a step, by name, in the plan's order. Immutable: a change creates a new object.

    version: increases with each change of a world's doors, from 0: equal versions of one world are equal states.
    """

    __slots__ = ("_states", "version")

    def __init__(self, states: Mapping[str, DoorState] = MappingProxyType({}), version: int = 0) -> None:
        self._states = dict(states)
        self.version = version

    @classmethod
    def at_start(cls, plan: FloorPlan) -> DoorStates:
        """Return the states of a plan's doors at the start."""
        states = {door.name: DoorState(door.closed, 0.0 if door.closed else 1.0) for door in plan.doors}
        return cls(states, version=0)

    def __getitem__(self, name: str) -> DoorState:
        return self._states[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._states)

    def __len__(self) -> int:
        return len(self._states)

    def closed(self) -> dict[str, bool]:
        """Return whether each door is closed, by name, in the plan's order."""
        return {name: state.closed for name, state in self._states.items()}

    def changes_since(self, before: DoorStates) -> list[DoorChange]:
        """Return the doors whose state differs from an earlier one, in the plan's order."""
        if self.version == before.version:
            return []
        pairs = [DoorChange(name, before[name], state) for name, state in self._states.items()]
        return [change for change in pairs if change.now != change.before]

    def closed_since(self, before: DoorStates) -> dict[str, bool]:
        """Return whether each door is closed that has been closed or opened since earlier states, by name."""
        return {name: now.closed for name, then, now in self.changes_since(before) if now.closed != then.closed}


def leaf_outline(door: Door, state: DoorState) -> Corners | None:
    """Return the corners of a leaf at its current position [m]; None for an open instant door, which has no leaf."""
    if door.motion != "instant":
        return leaf_corners(door, state.opening)
    return door_corners(door) if state.closed else None
