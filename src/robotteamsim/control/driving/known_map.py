"""The map that a robot carries: where its body fits in the known plan, and how far everything is by free paths."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable

import numpy as np

from robotteamsim import _core
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.plan import FREE, occupancy_grid
from robotteamsim.swarm import Vector

GRID_RESOLUTION_M = 0.1
MARGIN_M = 0.05
"""Kept between a robot's body and the plan, on top of what the conservative occupancy grid keeps."""

UNREACHABLE_M = 1e4
"""Added to the straight distance where no free path leads to a goal, so that any reachable place is better."""

_KEPT_FIELDS = 64


class KnownMap:
    """Free space of one plan for one size of robot, with doors as believed.

    The same places and doors give the same answers whatever was asked before; fields are kept because they are dear.
    """

    def __init__(self, plan: FloorPlan, robot_radius_m: float, closed_doors: tuple[tuple[str, bool], ...]) -> None:
        occupancy = occupancy_grid(plan, GRID_RESOLUTION_M, dict(closed_doors))
        self.grid = _core.plan.PlanningGrid(
            occupancy.cells != FREE, occupancy.origin_m, GRID_RESOLUTION_M, robot_radius_m + MARGIN_M
        )
        self._fields: dict[Vector, np.ndarray | None] = {}
        # Not wrapped: every robot asks several times in every iteration.
        self.along_path: Callable[[Vector, Vector, float], Vector] = self.grid.along_path
        """Returns a goal as the path to it from a start begins: at the path's length, in the direction of its
        `first_stretch`. The path is at most so long [m]."""
        self.reachable_towards: Callable[[Vector, Vector], Vector] = self.grid.reachable_towards
        """Returns the goal where the straight way to it from a start is free; else the place nearest to it that can be
        reached close by."""

    def distance_m(self, goal: Vector, position: Vector) -> float:
        """Return the length of the shortest free path [m]; UNREACHABLE_M and the straight distance without one."""
        field = self._field(goal)
        start = self.grid.nearest_free(position, 1.0)
        length_m = self.grid.value_at(field, start) if field is not None and start is not None else math.inf
        return length_m if math.isfinite(length_m) else UNREACHABLE_M + math.dist(goal, position)

    def nearest_by_path(self, goal: Vector, position: Vector, radius_m: float) -> tuple[Vector, float]:
        """Return the cell around a robot from which the path to a goal is shortest, and how long that is [m].

        The cells are those that the robot can reach within `radius_m` of it. Where the goal cannot be reached, the
        one nearest as the crow flies, with the length that `distance_m` gives.
        """
        field = self._field(goal)
        start = self.grid.nearest_free(position, 1.0)
        if field is not None and start is not None:
            best = self.grid.least_reachable(field, start, radius_m)
            if best is not None:
                return best
        cell = self.nearest_by_sight(goal, position, radius_m)
        return cell, self.distance_m(goal, cell)

    def nearest_by_sight(self, goal: Vector, position: Vector, radius_m: float) -> Vector:
        """Return the free cell within `radius_m` of a robot that is nearest to a goal as the crow flies."""
        cell = self.grid.nearest_in_disc(position, goal, radius_m)
        return position if cell is None else cell

    def first_stretch(self, start: Vector, goal: Vector, max_length_m: float) -> tuple[Vector, float]:
        """Return where a shortest path from `start` to `goal` first bends, and its whole length [m].

        The bend is `goal` itself, at its straight distance, where the way is free or no path of `max_length_m` exists.
        """
        return self.grid.first_stretch(start, goal, max_length_m)

    def _field(self, goal: Vector) -> np.ndarray | None:
        field = self._fields.get(goal)
        if field is None and goal not in self._fields:
            while len(self._fields) >= _KEPT_FIELDS:
                del self._fields[next(iter(self._fields))]
            free_goal = self.grid.nearest_free(goal, 5.0)
            field = self._fields[goal] = None if free_goal is None else self.grid.distance_map(free_goal)
        return field


@functools.lru_cache(maxsize=16)
def known_map(plan: FloorPlan, robot_radius_m: float, closed_doors: tuple[tuple[str, bool], ...] = ()) -> KnownMap:
    """Return the map for a plan, a robot's radius [m] and doors believed otherwise than the plan says.

    Robots and trials share it: its content depends on these values alone.
    """
    return KnownMap(plan, robot_radius_m, closed_doors)
