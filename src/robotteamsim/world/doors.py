"""Doors as they are: the one place that says whether a door is open or closed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from robotteamsim import _core
from robotteamsim.scenario.floor_plan import Door
from robotteamsim.scenario.plan import Corners, door_corners, leaf_corners
from robotteamsim.world.pieces import convex_pieces

LeafMotion = Literal["still", "opens", "closes", "held"]


@dataclass(frozen=True, slots=True)
class DoorState:
    """A door as it is after a step.

    closed:  whether the leaf is all across its gap. Radio, voices and the mission go by this and nothing else.
    opening: how far it is open: 0 closed .. 1 open; of a door without a moving leaf one of both.
    motion:  of its leaf: still, opens, closes, or held by something in its way.
    """

    closed: bool
    opening: float
    motion: LeafMotion = "still"


def door_at_start(door: Door) -> DoorState:
    """Return the state of a door at the start."""
    return DoorState(door.closed, 0.0 if door.closed else 1.0)


def core_door(door: Door) -> _core.world.Door:
    """Return a door of the C++ world."""
    leaf = door_corners(door)
    return _core.world.Door(
        _core.world.Solid(leaf, convex_pieces(leaf)),
        door.closed,
        time_s=door.leaf_time_s,
        angle_rad=door.leaf_angle_rad,
        shift_m=door.leaf_shift_m,
        hinge_m=door.start,
    )


def door_state(state: _core.world.DoorState) -> DoorState:
    """Return the state of a door of the C++ world."""
    return DoorState(state.closed, state.opening, state.motion)


def leaf_outline(door: Door, state: DoorState) -> Corners | None:
    """Return the corners of a leaf where it is [m]; None: nowhere."""
    if door.motion != "instant":
        return leaf_corners(door, state.opening)
    return door_corners(door) if state.closed else None
