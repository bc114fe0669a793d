"""Random wandering, of excluded robots and of robots without a goal."""

import math

import numpy as np

from robotteamsim.control.driving.known_map import GRID_RESOLUTION_M, KnownMap
from robotteamsim.scenario.controllers.driving import WanderTuning
from robotteamsim.swarm import Vector

TRIES = 8
"""Number of directions tried for a leg. If all legs are short, the longest is used; more tries would rarely help."""


class Wander:
    """Random straight legs over the known map: a new direction at the end of each, or when one takes too long."""

    def __init__(self, tuning: WanderTuning, generator: np.random.Generator, speed_mps: float) -> None:
        self._tuning = tuning
        self._rng = generator
        self._speed_mps = speed_mps
        self._goal: Vector | None = None
        self._until_s = 0.0

    def goal(self, free_space: KnownMap, position: Vector, time_s: float) -> Vector:
        """Return the end of the current leg, in `map` [m]."""
        if self._goal is None or time_s >= self._until_s or math.dist(position, self._goal) < self._tuning.arrived_m:
            self._goal = self._next_goal(free_space, position)
            travel_s = self._tuning.timeout_factor * math.dist(position, self._goal) / self._speed_mps
            self._until_s = time_s + self._tuning.timeout_s + travel_s
        return self._goal

    def stop(self) -> None:
        """Discard the current leg; the next call starts a new one."""
        self._goal = None

    def _next_goal(self, free_space: KnownMap, position: Vector) -> Vector:
        shortest_m, longest_m = self._tuning.shortest_leg_m, self._tuning.longest_leg_m
        start = free_space.grid.nearest_free(position, 1.0) or position
        best, best_m = position, -1.0
        for _ in range(TRIES):
            heading_rad, length_m = (self._rng.random(2) * (math.tau, longest_m - shortest_m)).tolist()
            end = free_end(free_space, start, heading_rad, length_m + shortest_m)
            end_m = math.dist(start, end)
            if end_m > best_m:
                best, best_m = end, end_m
            if end_m >= shortest_m:
                break
        return best


def free_end(free_space: KnownMap, start: Vector, heading_rad: float, length_m: float) -> Vector:
    """Return the farthest point in a direction, up to `length_m`, to which the straight line is free."""
    end = start
    for i in range(1, int(length_m / GRID_RESOLUTION_M) + 1):
        reach_m = i * GRID_RESOLUTION_M
        point = (start[0] + reach_m * math.cos(heading_rad), start[1] + reach_m * math.sin(heading_rad))
        if not free_space.grid.is_line_free(end, point):
            break
        end = point
    return end
