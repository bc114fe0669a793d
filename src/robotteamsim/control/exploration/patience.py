"""When a robot gives up a place that it does not get to."""

from __future__ import annotations

import math

import numpy as np

from robotteamsim.scenario.controllers.routes import RouteControl
from robotteamsim.swarm import Vector

SAME_M = 2.0
"""Places this near to each other are the same one: the end of the known floor moves as a robot comes nearer."""


class Patience:
    """Counts the time that a robot wastes on each place, and so gives some of them up.

    On the way to a place, time is wasted as far as it is more than `timeout_factor` times as long as the path became
    shorter; at the place, all of it is. A place at which more than `timeout_s` was wasted is given up.
    """

    def __init__(self, tuning: RouteControl) -> None:
        self._spared_s, self._s_per_m = tuning.timeout_s, tuning.timeout_factor / tuning.max_step_speed_mps
        self._places: list[Vector] = []
        self._wasted_s: list[float] = []
        self._last: int | None = None
        self._length_m = 0.0

    def spend(self, place: Vector, length_m: float, spent_s: float) -> None:
        """Note that a robot is on its way to a place. Args: spent_s: since the last call, which may be of another one.

        length_m: of the path that is left.
        """
        near = (index for index, other in enumerate(self._places) if math.dist(other, place) < SAME_M)
        index = next(near, len(self._places))
        if index == len(self._places):
            self._places.append(place)
            self._wasted_s.append(0.0)
        if index == self._last:
            earned_s = self._s_per_m * max(self._length_m - length_m, 0.0)
            self._wasted_s[index] = max(self._wasted_s[index] + spent_s - earned_s, 0.0)
        self._last, self._length_m = index, length_m

    def given_up(self, places_m: np.ndarray) -> np.ndarray:
        """Return which places are given up, bool, shape (n,). Args: places_m: shape (n, 2)."""
        is_lost = np.zeros(len(places_m), dtype=bool)
        for place, wasted_s in zip(self._places, self._wasted_s, strict=True):
            if wasted_s > self._spared_s:
                is_lost |= np.hypot(*(places_m - place).T) < SAME_M
        return is_lost
