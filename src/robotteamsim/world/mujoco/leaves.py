"""The leaves of doors, moved from outside; they never push, and wait while something is in their way."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import shapely

from robotteamsim.geometry import Pose
from robotteamsim.scenario.body import Body
from robotteamsim.scenario.floor_plan import Door, FloorPlan
from robotteamsim.scenario.plan import door_corners, leaf_corners
from robotteamsim.world.doors import DoorState

_GLANCE_M = 0.01
"""A leaf checks after each such part of its motion whether something blocks it."""
_CLEAR_M = 0.005
"""Its distance from anything."""
_AT_END = 1e-9
"""A leaf this near to its end, as a fraction of its motion, has arrived: the difference is rounding."""


@dataclass(slots=True)
class _Leaf:
    door: Door
    opening: float
    closes: bool
    is_held: bool = False

    @property
    def end(self) -> float:
        return 0.0 if self.closes else 1.0

    @property
    def state(self) -> DoorState:
        if self.opening == self.end:
            return DoorState(self.opening == 0.0, self.opening)
        return DoorState(False, self.opening, "held" if self.is_held else "closes" if self.closes else "opens")


class Leaves:
    """All doors of a plan, by their index in it."""

    def __init__(self, plan: FloorPlan) -> None:
        self._leaves = [_Leaf(door, 0.0 if door.closed else 1.0, door.closed) for door in plan.doors]
        self.version = 0
        """Increases with each change of a state."""
        self._states = self.states()

    def states(self) -> list[DoorState]:
        """Return the states of the doors."""
        return [leaf.state for leaf in self._leaves]

    def note_changes(self) -> None:
        """Increase the version if a state has changed since the last call."""
        states = self.states()
        if states != self._states:
            self._states = states
            self.version += 1

    def set_closed(self, index: int, closed: bool) -> None:
        """Let a door close or open; an instant one does so at once."""
        leaf = self._leaves[index]
        leaf.closes, leaf.is_held = closed, False
        if leaf.door.motion == "instant":
            leaf.opening = leaf.end
        self.note_changes()

    def pose(self, index: int) -> Pose | None:
        """Return the pose of a leaf, whose origin is the hinge, relative to its closed one in `map`; None: no leaf."""
        leaf = self._leaves[index]
        if leaf.door.motion == "instant" and leaf.opening > 0.0:
            return None
        (x_m, y_m), (shift_x_m, shift_y_m) = leaf.door.start, leaf.door.leaf_shift_m
        return Pose(
            x_m + shift_x_m * leaf.opening, y_m + shift_y_m * leaf.opening, leaf.door.leaf_angle_rad * leaf.opening
        )

    def covers_any(self, index: int, bodies: Callable[[], Sequence[Body]]) -> bool:
        """Whether the leaf of a closed instant door overlaps a robot or an object; others never do."""
        door = self._leaves[index].door
        if door.motion != "instant":
            return False
        leaf = shapely.Polygon(door_corners(door))
        return any(body.overlaps_shape(leaf, _CLEAR_M) for body in bodies())

    def advance(self, time_s: float, bodies: Callable[[], Sequence[Body]]) -> list[int]:
        """Move the leaves for a time; return the indices of those that may have moved.

        Args: bodies: returns the robots and objects at their current poses; called only if a leaf moves.
        """
        moving = [index for index, leaf in enumerate(self._leaves) if leaf.opening != leaf.end]
        if moving:
            around = bodies()
            for index in moving:
                _advance(self._leaves[index], time_s, around)
        return moving


def _advance(leaf: _Leaf, time_s: float, bodies: Sequence[Body]) -> None:
    door = leaf.door
    length_m = math.dist(door.start, door.end) + door.thickness_m
    travel_m = abs(door.leaf_angle_rad) * length_m + math.hypot(*door.leaf_shift_m)
    parts = max(1, math.ceil(travel_m * time_s / door.leaf_time_s / _GLANCE_M))
    part = time_s / door.leaf_time_s / parts * (-1.0 if leaf.closes else 1.0)
    leaf.is_held = False
    for _ in range(parts):
        reached = leaf.opening + part
        following = leaf.end if abs(leaf.end - reached) < _AT_END else min(max(reached, 0.0), 1.0)
        if _is_blocked(door, leaf.opening, following, bodies):
            leaf.is_held = True
            return
        leaf.opening = following
        if leaf.opening == leaf.end:
            return


def _is_blocked(door: Door, opening: float, following: float, bodies: Sequence[Body]) -> bool:
    """Whether a leaf would come too near to something; one that moves away from what it touches would not."""
    now, then = (shapely.Polygon(leaf_corners(door, fraction)) for fraction in (opening, following))
    for body in bodies:
        gap_m = shapely.distance(body.core, then) - body.margin_m
        if gap_m < _CLEAR_M and gap_m < shapely.distance(body.core, now) - body.margin_m:
            return True
    return False
