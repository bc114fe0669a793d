"""Places where no victim can be, though a voice is heard there."""

from __future__ import annotations

import functools
import math

from robotteamsim.scenario.scenario import Scenario
from robotteamsim.swarm import Vector

_SAME_PLACE_M = 0.25


class RuledOut:
    """What the team has learnt of where victims are not since the voice map last changed.

    Within the local-best radius of a robot, a victim can only be at the loudest cell that it hears; and not even
    there once a robot was next to it, for she would be saved, and silent [5.3]. Without this a voice from behind a
    wall, loudest at that wall, holds the swarm there until all robots are excluded.
    """

    def __init__(self, scenario: Scenario) -> None:
        self._radius_m = scenario.voice.local_best_radius_m
        self._cell_m = scenario.voice.map_resolution_m
        # The victim may be anywhere in her cell of the voice map.
        save_m = scenario.mission.save_distance_m
        self._next_to_m = max(0.5 * save_m, save_m - self._cell_m)
        self._bucket_m = max(self._radius_m, self._next_to_m)
        self._buckets: dict[tuple[int, int], list[tuple[Vector, Vector | None]]] = {}
        self._known: set[tuple[int, int, Vector | None]] = set()
        self._answers: dict[Vector, bool] = {}
        self._covered: set[Vector] = set()
        """Places that were found to be covered; they stay so until all is forgotten."""

    def clear(self) -> None:
        """Forget everything: the voice map is another."""
        self._buckets.clear()
        self._known.clear()
        self._answers.clear()
        self._covered.clear()

    def add(self, position: Vector, loudest: Vector | None) -> None:
        """Note the loudest cell that a robot hears from where it is; none if it hears nothing."""
        key, bucket = _key_and_bucket(position, loudest, self._bucket_m)
        if key not in self._known:
            self._known.add(key)
            self._answers.clear()
            self._buckets.setdefault(bucket, []).append((position, loudest))

    def covers(self, place: Vector) -> bool:
        """Whether the victim whose voice is heard at a cell cannot be there."""
        if place not in self._answers:
            self._answers[place] = self._finds(place)
        return self._answers[place]

    def _finds(self, place: Vector) -> bool:
        if place in self._covered:
            return True
        if self._is_covered(place):
            self._covered.add(place)
            return True
        return False

    def _is_covered(self, place: Vector) -> bool:
        column, row = _bucket_of(place, self._bucket_m)
        for i in (column - 1, column, column + 1):
            for j in (row - 1, row, row + 1):
                for position, loudest in self._buckets.get((i, j), ()):
                    distance_m = math.dist(place, position)
                    if distance_m < self._next_to_m:
                        return True
                    if distance_m < self._radius_m and not self._is_same_cell(place, loudest):
                        return True
        return False

    def _is_same_cell(self, place: Vector, loudest: Vector | None) -> bool:
        return loudest is not None and math.dist(place, loudest) < 0.5 * self._cell_m


# All robots of one process that hear a report ask for these.
@functools.lru_cache(maxsize=8192)
def _key_and_bucket(
    position: Vector, loudest: Vector | None, bucket_m: float
) -> tuple[tuple[int, int, Vector | None], tuple[int, int]]:
    key = round(position[0] / _SAME_PLACE_M), round(position[1] / _SAME_PLACE_M), loudest
    return key, _bucket_of(position, bucket_m)


def _bucket_of(place: Vector, bucket_m: float) -> tuple[int, int]:
    return math.floor(place[0] / bucket_m), math.floor(place[1] / bucket_m)
