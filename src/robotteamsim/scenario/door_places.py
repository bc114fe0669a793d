"""Checks that the doors of a plan are in gaps between walls."""

from collections.abc import Sequence

import numpy as np
import shapely

from robotteamsim.scenario.floor_plan import Door, FloorPlan
from robotteamsim.scenario.plan import footprints, solids

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
    if not plan.doors:
        return []
    static = [solid for solid in solids(plan) if solid.kind != "door"]
    shapes = footprints(static)
    border = shapely.box(*plan.bounds.min, *plan.bounds.max).exterior
    around = _inside(plan.doors, shapes)
    away_m = _away_m(plan.doors, np.append(shapes, border))
    hit = _swung_into(plan.doors, shapes)
    wrong = []
    for index, door in enumerate(plan.doors):
        leaf = f"the leaf [{door.start[0]:g}, {door.start[1]:g}] .. [{door.end[0]:g}, {door.end[1]:g}]"
        if index in around:
            solid = static[around[index]]
            wrong.append((index, f"{leaf} lies in {solid.kind} '{solid.name}'; expected a gap"))
        elif away_m[index] > REACH_M:
            wrong.append((index, f"{leaf} is not at a wall: the nearest is {away_m[index]:.2g} m away"))
        elif index in hit:
            solid = static[hit[index]]
            wrong.append((index, f"{leaf} swings into {solid.kind} '{solid.name}'; expected free space"))
    return wrong


def without_misplaced_doors(plan: FloorPlan) -> FloorPlan:
    """Return a plan without the doors that `misplaced_doors` names."""
    wrong = {index for index, _ in misplaced_doors(plan)}
    doors = tuple(door for index, door in enumerate(plan.doors) if index not in wrong)
    return plan.model_copy(update={"doors": doors})


def _ends_m(doors: Sequence[Door]) -> np.ndarray:
    """Return both ends of each leaf, shape (n, 2, 2) [m]."""
    return np.array([(door.start, door.end) for door in doors])


def _inside(doors: Sequence[Door], shapes: np.ndarray) -> dict[int, int]:
    """Return, for each door whose leaf is mostly in solids, the one that contains most of it; both by index."""
    leaves = shapely.linestrings(_ends_m(doors))
    door, solid = shapely.STRtree(shapes).query(leaves, predicate="intersects")
    covered_m = shapely.length(shapely.intersection(shapes[solid], leaves[door]))
    most_m = MOST_IN_SOLIDS * shapely.length(leaves)
    found = {}
    for index in np.flatnonzero(np.bincount(door, covered_m, len(leaves)) > most_m).tolist():
        own = np.flatnonzero(door == index)
        union = shapely.union_all(shapes[solid[own]])  # solids may overlap
        if shapely.length(shapely.intersection(union, leaves[index])) > most_m[index]:
            longest = own[covered_m[own] == covered_m[own].max()]
            found[index] = int(solid[longest].min())
    return found


def _away_m(doors: Sequence[Door], shapes: np.ndarray) -> np.ndarray:
    """Return how far the nearer end of each leaf is from the nearest shape, shape (n,) [m]."""
    hinges = shapely.multipoints(_ends_m(doors))
    _, away_m = shapely.STRtree(shapes).query_nearest(hinges, return_distance=True, all_matches=False)
    return np.asarray(away_m)


def _swung_into(doors: Sequence[Door], shapes: np.ndarray) -> dict[int, int]:
    """Return, for each door that hits a solid as it swings, the first solid; both by index.

    Contact near its hinge and along a wall is ignored.
    """
    swings = [index for index, door in enumerate(doors) if door.motion == "swing"]
    tree = shapely.STRtree(shapely.buffer(shapes, -LEANING_M) if swings else [])
    found = {}
    for index, (start, end) in zip(swings, _ends_m(doors)[swings], strict=True):
        angle_rad = doors[index].leaf_angle_rad
        turns_rad = np.linspace(0.0, angle_rad, 2 + int(abs(angle_rad) * np.hypot(*(end - start)) / 0.05))[1:]
        cos, sin = np.cos(turns_rad), np.sin(turns_rad)
        turned = np.array([[cos, sin], [-sin, cos]]).T @ (end - start)
        leaves = start + turned[:, None, :] * np.array([HINGE_PART, 1.0])[:, None]
        _, hit = tree.query(shapely.linestrings(leaves), predicate="intersects")
        if len(hit):
            found[index] = int(hit.min())
    return found
