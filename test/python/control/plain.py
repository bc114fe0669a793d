"""Second implementations, in Python, of some functions of the C++ library for controllers, equal to the bit."""

from __future__ import annotations

import itertools
import math

import numpy as np

from robotteamsim.geometry import Pose
from robotteamsim.scenario.sections import Laser
from robotteamsim.swarm import Vector


class PlainClearance:
    """What a scan says of the room around a robot."""

    def __init__(self, laser: Laser) -> None:
        self._laser = laser
        step_rad = (laser.angle_max_rad - laser.angle_min_rad) / (laser.beams - 1)
        self._angles_rad = [laser.angle_min_rad + i * step_rad for i in range(laser.beams)]

    def hits(self, ranges_m: np.ndarray, max_distance_m: float) -> list[Vector]:
        longest_m = self._laser.range_max_m * (1.0 - 1e-6)
        hits = [
            (self._laser.forward_m + range_m * math.cos(angle_rad), range_m * math.sin(angle_rad))
            for range_m, angle_rad in zip(ranges_m.tolist(), self._angles_rad, strict=True)
            if range_m < longest_m
        ]
        return [(x, y) for x, y in hits if x * x + y * y < max_distance_m * max_distance_m]

    def free_distance(self, ranges_m: np.ndarray, heading_rad: float, radius_m: float, max_distance_m: float) -> float:
        cos, sin = math.cos(heading_rad), math.sin(heading_rad)
        free_m = max_distance_m
        for x, y in self.hits(ranges_m, max_distance_m + radius_m):
            along, across = x * cos + y * sin, y * cos - x * sin
            if along <= 0.0 or radius_m * radius_m - across * across <= 0.0:
                continue
            touch = along - math.sqrt(radius_m * radius_m - across * across)
            if touch >= 0.0:
                free_m = min(free_m, touch)
            elif along * along > 0.25 * (along * along + across * across):
                return 0.0
        return free_m


class PlainSurroundings:
    """The obstacle term of one robot."""

    def __init__(self, laser: Laser, sensing_radius_m: float) -> None:
        self._stride = max(1, laser.beams // 60)
        beams = len(range(0, laser.beams, self._stride))
        last_rad = laser.angle_min_rad
        last_rad += (beams - 1) * self._stride * (laser.angle_max_rad - laser.angle_min_rad) / (laser.beams - 1)
        self._clearance = PlainClearance(laser.model_copy(update={"beams": beams, "angle_max_rad": last_rad}))
        self._radius_m = sensing_radius_m
        self._headings_rad = np.linspace(laser.angle_min_rad, laser.angle_max_rad, 13).tolist()

    def attractor(self, pose: Pose, ranges_m: np.ndarray) -> Vector | None:
        ranges_m = ranges_m[:: self._stride]
        if not self._clearance.hits(ranges_m, self._radius_m):
            return None
        candidates_m = [
            (reach_m * math.cos(heading_rad), reach_m * math.sin(heading_rad))
            for heading_rad in self._headings_rad
            for reach_m in (0.5 * self._radius_m, self._radius_m)
            if reach_m <= self._clearance.free_distance(ranges_m, heading_rad, 0.05, self._radius_m)
        ]
        hits_m = self._clearance.hits(ranges_m, 2.0 * self._radius_m)
        x, y = plain_farthest(hits_m, [(0.0, 0.0), *candidates_m])
        cos, sin = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
        return pose.x_m + cos * x - sin * y, pose.y_m + sin * x + cos * y


def plain_farthest(hits_m: list[Vector], places_m: list[Vector]) -> Vector:
    """Return the first of the places whose nearest hit is farthest away."""
    return max(places_m, key=lambda place: min(math.dist(place, hit) for hit in hits_m))


class PlainRuledOut:
    """What is known of where victims are not."""

    def __init__(self, radius_m: float, cell_m: float, next_to_m: float) -> None:
        self._radius_m, self._cell_m, self._next_to_m = radius_m, cell_m, next_to_m
        self._notes: dict[tuple[int, int, Vector | None], tuple[Vector, Vector | None]] = {}

    def add(self, position: Vector, loudest: Vector | None) -> None:
        key = (round(position[0] / 0.25), round(position[1] / 0.25), loudest)
        self._notes.setdefault(key, (position, loudest))

    def covers(self, place: Vector) -> bool:
        return any(self._rules_out(place, *note) for note in self._notes.values())

    def _rules_out(self, place: Vector, position: Vector, loudest: Vector | None) -> bool:
        distance_m = math.dist(place, position)
        is_it = loudest is not None and math.dist(place, loudest) < 0.5 * self._cell_m
        return distance_m < self._next_to_m or (distance_m < self._radius_m and not is_it)


def plain_first_stretch(grid, start: Vector, goal: Vector, max_length_m: float) -> tuple[Vector, float]:
    straight_m = math.dist(start, goal)
    if grid.is_line_free(start, goal):
        return goal, straight_m
    free_start, free_goal = grid.nearest_free(start, 1.0), grid.nearest_free(goal, 1.0)
    if free_start is None or free_goal is None:
        return goal, straight_m
    corners = grid.waypoints(free_start, free_goal, max_length_m)
    if len(corners) < 2:
        return goal, straight_m
    length_m = 0.0  # `sum` adds more exactly from Python 3.12 on
    for a, b in itertools.pairwise(corners):
        length_m += math.dist(a, b)
    return corners[1], length_m


def plain_along_path(grid, start: Vector, goal: Vector, max_length_m: float) -> Vector:
    bend, length_m = plain_first_stretch(grid, start, goal, max_length_m)
    bend_m = math.dist(start, bend)
    if bend == goal or bend_m == 0.0:
        return goal
    stretch = length_m / bend_m
    return start[0] + stretch * (bend[0] - start[0]), start[1] + stretch * (bend[1] - start[1])
