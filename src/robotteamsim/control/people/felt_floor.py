"""Feeling the way: walking over the floor near a place where a victim must be, but cannot be seen."""

from __future__ import annotations

import math

import numpy as np

from robotteamsim.control.driving.hot_places import HotPlaces
from robotteamsim.control.driving.known_map import KnownMap
from robotteamsim.scenario.base import Point

_SPACING_M = 0.5
"""Of the points to come near to [m]."""
_LONGEST_DETOUR = 3.0
"""Points to which the path is longer than this many radii, behind long walls, are left out."""
_STUCK_S = 15.0
"""After this time on the way to a point, another one is tried [s]."""


class FeltFloor:
    """The floor near a place, point by point: those that a firefighter has come near to, and those that are left.

    Args: place:    in `map` [m].
          radius_m: how far from the place the victim may be [m].
          near_m:   within this distance, a firefighter has felt a point [m].
    """

    def __init__(self, known: KnownMap, place: Point, radius_m: float, near_m: float) -> None:
        self._place, self._near_m = place, near_m
        self._left = [place, *self._points(known, place, radius_m)]
        self._goal: Point | None = place
        self._since_s: float | None = None
        """Since when the firefighter has been on the way to the goal [s]."""

    def next_point(self, position: Point, time_s: float, hot: HotPlaces) -> Point | None:
        """Return the point in `map` to go to [m]: the place, then the nearest one that is left; None: none is left.

        Args: hot: points in hot places are left out.
        """
        if self._goal is not None and self._since_s is not None and time_s - self._since_s > _STUCK_S:
            self._left.remove(self._goal)
        self._left = [
            point for point in self._left if math.dist(point, position) > self._near_m and not hot.is_hot(point)
        ]
        if self._since_s is None or self._goal not in self._left:
            nearest = min(self._left, key=lambda point: math.dist(point, position), default=None)
            self._goal = self._place if self._place in self._left else nearest
            self._since_s = time_s
        return self._goal

    @staticmethod
    def _points(known: KnownMap, place: Point, radius_m: float) -> list[Point]:
        middle = known.grid.nearest_free(place, radius_m)
        if middle is None:
            return []
        lengths_m = known.grid.distance_map(middle)
        offsets_m = np.arange(-radius_m, radius_m + 0.5 * _SPACING_M, _SPACING_M).tolist()
        points = [(place[0] + x, place[1] + y) for y in offsets_m for x in offsets_m if math.hypot(x, y) <= radius_m]
        return [
            point
            for point in points
            if known.grid.is_free(point) and known.grid.value_at(lengths_m, point) <= _LONGEST_DETOUR * radius_m
        ]
