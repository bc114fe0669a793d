"""Whether the doors of a plan hang where doors hang."""

from __future__ import annotations

import numpy as np
import shapely

from robotteamsim.scenario.floor_plan import Door, FloorPlan
from robotteamsim.scenario.plan import solids

REACH_M = 0.1
"""A leaf hangs at a solid, or at the border of the plan, that is this near to one of its ends."""

MOST_IN_SOLIDS = 0.5
"""Of a leaf's length; what lies in walls neither opens nor closes anything."""


def misplaced_doors(plan: FloorPlan) -> list[tuple[int, str]]:
    """Return the index of each door that is off its wall or in a wall, and what is wrong with it.

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
    return wrong


def _text(door: Door) -> str:
    return f"the leaf [{door.start[0]:g}, {door.start[1]:g}] .. [{door.end[0]:g}, {door.end[1]:g}]"
