"""Checks that the doors of a plan are in gaps between walls."""

from collections.abc import Sequence

import numpy as np
import shapely
import shapely.affinity
import shapely.ops

from robotteamsim.scenario.floor_plan import Door, FloorPlan
from robotteamsim.scenario.plan import Solid, solids

REACH_M = 0.1
"""At least one end of a leaf must be within this distance of a solid or of the border of the plan."""

MOST_IN_SOLIDS = 0.5
"""Share of a leaf's length that may be in solids: a door inside a wall neither opens nor closes anything."""

HINGE_PART = 0.15
"""Share of a leaf's length at its hinge that may touch the wall it is hinged to."""

LEANING_M = 0.01
"""An open leaf may lie along a wall, up to this far within its face."""


def misplaced_doors(plan: FloorPlan) -> list[tuple[int, str]]:
    """Return the index of each door that is not at a wall, is inside one, or swings into one, and what is wrong.

    At least one end of a leaf must be at a wall, block or pillar, and at least half of it in the gap. A double door is
    two leaves, each at its own side.
    """
    static = [solid for solid in solids(plan) if solid.kind != "door"]
    shapes = np.array([solid.polygon for solid in static], dtype=object)
    tree = shapely.STRtree(shapes)
    around = shapely.box(*plan.bounds.min, *plan.bounds.max).exterior
    wrong = []
    for index, door in enumerate(plan.doors):
        leaf = shapely.LineString([door.start, door.end])
        crossed = np.sort(tree.query(leaf, predicate="intersects"))
        in_solids = shapely.intersection(shapely.union_all(shapes[crossed]), leaf)
        hinges = shapely.MultiPoint([door.start, door.end])
        _, distances_m = tree.query_nearest(hinges, return_distance=True, all_matches=False)
        nearest_m = min([shapely.distance(around, hinges), *distances_m])
        if in_solids.length > MOST_IN_SOLIDS * leaf.length:
            lengths_m = shapely.length(shapely.intersection(shapes[crossed], leaf))
            solid = static[crossed[int(np.argmax(lengths_m))]]
            wrong.append((index, f"{_text(door)} lies in {solid.kind} '{solid.name}'; expected a gap"))
        elif nearest_m > REACH_M:
            wrong.append((index, f"{_text(door)} is not at a wall: the nearest is {nearest_m:.2g} m away"))
        elif door.motion == "swing" and (hit := _swings_into(door, static)):
            wrong.append((index, f"{_text(door)} swings into {hit.kind} '{hit.name}'; expected free space"))
    return wrong


def without_misplaced_doors(plan: FloorPlan) -> FloorPlan:
    """Return a plan without the doors that `misplaced_doors` names."""
    wrong = {index for index, _ in misplaced_doors(plan)}
    doors = tuple(door for index, door in enumerate(plan.doors) if index not in wrong)
    return plan.model_copy(update={"doors": doors})


def _swings_into(door: Door, static: Sequence[Solid]) -> Solid | None:
    """Return what a leaf hits as it swings, ignoring contact near its hinge and along a wall."""
    leaf = shapely.LineString([door.start, door.end])
    outer = shapely.ops.substring(leaf, HINGE_PART, 1.0, normalized=True)
    turns_rad = np.linspace(0.0, door.leaf_angle_rad, 2 + int(abs(door.leaf_angle_rad) * leaf.length / 0.05))
    swept = shapely.union_all(
        [shapely.affinity.rotate(outer, turn_rad, door.start, use_radians=True) for turn_rad in turns_rad[1:]]
    )
    return next((solid for solid in static if swept.intersects(solid.polygon.buffer(-LEANING_M))), None)


def _text(door: Door) -> str:
    return f"the leaf [{door.start[0]:g}, {door.start[1]:g}] .. [{door.end[0]:g}, {door.end[1]:g}]"
