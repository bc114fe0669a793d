"""The floor, walls, blocks and doors of a plan as parts of a MuJoCo model."""

from __future__ import annotations

from typing import Any

import mujoco

from robotteamsim.palette import LIT_DOORS, LIT_SOLIDS
from robotteamsim.scenario.floor_plan import Door, FloorPlan
from robotteamsim.scenario.plan import Corners, door_corners
from robotteamsim.world.core_parts import convex_pieces, still_solids
from robotteamsim.world.mujoco.appearance import FLOOR
from robotteamsim.world.mujoco.shapes import (
    BODIES,
    BUILDING_GROUP,
    FLOOR_GROUP,
    GROUND,
    LEAF_PRIORITY,
    add_prism,
    rgba,
)

_SLIVER_M2 = 1e-6
"""Smaller pieces of a block are left out: they are rounding errors, of which no hull can be made."""


def leaf_name(door: Door) -> str:
    """Return the name of the body of a door's leaf."""
    return f"door {door.name}"


def add_building(spec: mujoco.MjSpec, plan: FloorPlan, friction: float) -> None:
    """Add a plan to the spec. Leaves are bodies that are moved from outside, with their hinges as origins.

    Args: friction: of leaves.
    """
    _add_floor(spec, plan)
    solids, _ = still_solids(plan)
    for solid in solids:
        pieces = [piece for piece in convex_pieces(solid.corners) if _area_m2(piece) > _SLIVER_M2]
        for index, piece in enumerate(pieces):
            name = f"{solid.kind} {solid.name}" + (f" {index}" if len(pieces) > 1 else "")
            top_m, colour = solid.element.height_m, rgba(LIT_SOLIDS[solid.kind])
            _add_solid(spec, spec.worldbody, name, piece, top_m, colour)
    for door in plan.doors:
        x_m, y_m = door.start
        body = spec.worldbody.add_body(name=leaf_name(door), pos=[x_m, y_m, 0.0], mocap=True)
        corners = tuple((x - x_m, y - y_m) for x, y in door_corners(door))
        keys = {"priority": LEAF_PRIORITY, "friction": [friction, 0.0, 0.0]}
        _add_solid(spec, body, leaf_name(door), corners, door.height_m, rgba(LIT_DOORS[door.kind]), **keys)


def _add_floor(spec: mujoco.MjSpec, plan: FloorPlan) -> None:
    (x0, y0), (x1, y1) = plan.bounds.min, plan.bounds.max
    spec.worldbody.add_geom(
        name="floor",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        pos=[0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.0],
        size=[0.5 * (x1 - x0), 0.5 * (y1 - y0), 1.0],
        contype=GROUND,
        conaffinity=0,
        group=FLOOR_GROUP,
        material=FLOOR,
    )


def _add_solid(
    spec: mujoco.MjSpec, body: Any, name: str, corners: Corners, top_m: float, colour: list[float], **keys: Any
) -> None:
    keys |= {"contype": BODIES, "conaffinity": 0, "group": BUILDING_GROUP, "rgba": colour}
    add_prism(spec, body, name, corners, 0.0, top_m, **keys)


def _area_m2(corners: Corners) -> float:
    following = (*corners[1:], corners[0])
    return 0.5 * sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in zip(corners, following, strict=True))
