"""Whether the doors of a plan hang where doors hang."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
import shapely.affinity
import shapely.ops

from robotteamsim.scenario.floor_plan import Door, FloorPlan
from robotteamsim.scenario.plan import Solid, solids

REACH_M = 0.1
"""A leaf hangs at a solid, or at the border of the plan, that is this near to one of its ends."""

MOST_IN_SOLIDS = 0.5
"""Of a leaf's length; what lies in walls neither opens nor closes anything."""

HINGE_PART = 0.15
"""Of a leaf's length: so near to its hinge it may meet the wall that it hangs at."""

LEANING_M = 0.01
"""An open leaf may lie along a wall, up to this far within its face."""


def misplaced_doors(plan: FloorPlan) -> list[tuple[int, str]]:
    """Return the index of each door that is off its wall, in a wall, or swings into one, and what is wrong with it.

    A leaf hangs at a wall, block or pillar by at least one of its ends, and at least half of it is in the gap. Of a
    double door each leaf hangs at its own side.
    """
    static = [solid for solid in solids(plan) if solid.kind != "door"]
    shapes = np.array([solid.polygon for solid in static], dtype=object)
    around = shapely.box(*plan.bounds.min, *plan.bounds.max).exterior
    wrong = []
    for index, door in enumerate(plan.doors):
        leaf = shapely.LineString([door.start, door.end])
        lengths_m = shapely.length(shapely.intersection(shapes, leaf))
        hinges = shapely.MultiPoint([door.start, door.end])
        nearest_m = min([shapely.distance(around, hinges), *shapely.distance(shapes, hinges)])
        if shapely.length(shapely.intersection(shapely.union_all(shapes), leaf)) > MOST_IN_SOLIDS * leaf.length:
            solid = static[int(np.argmax(lengths_m))]
            wrong.append((index, f"{_text(door)} lies in {solid.kind} '{solid.name}'; wanted a gap"))
        elif nearest_m > REACH_M:
            wrong.append((index, f"{_text(door)} hangs at no wall: the nearest is {nearest_m:.2g} m away"))
        elif door.motion == "swing" and (hit := _swings_into(door, static)):
            wrong.append((index, f"{_text(door)} swings into {hit.kind} '{hit.name}'; wanted a free way"))
    return wrong


def _swings_into(door: Door, static: Sequence[Solid]) -> Solid | None:
    """Return what a leaf meets on its way: past its hinge, and by more than leaning along it."""
    leaf = shapely.LineString([door.start, door.end])
    outer = shapely.ops.substring(leaf, HINGE_PART, 1.0, normalized=True)
    turns_rad = np.linspace(0.0, door.leaf_angle_rad, 2 + int(abs(door.leaf_angle_rad) * leaf.length / 0.05))
    way = shapely.union_all(
        [shapely.affinity.rotate(outer, turn_rad, door.start, use_radians=True) for turn_rad in turns_rad[1:]]
    )
    return next((solid for solid in static if way.intersects(solid.polygon.buffer(-LEANING_M))), None)


def _text(door: Door) -> str:
    return f"the leaf [{door.start[0]:g}, {door.start[1]:g}] .. [{door.end[0]:g}, {door.end[1]:g}]"
