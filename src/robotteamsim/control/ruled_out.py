"""Places where no victim can be, though a voice is heard there."""

from __future__ import annotations

import functools
import math
from typing import NamedTuple

from robotteamsim.scenario.scenario import Scenario
from robotteamsim.swarm import Vector

_SAME_PLACE_M = 0.25

Heard = tuple[tuple[Vector, Vector | None], ...]
"""Where robots are, and the loudest cell that each of them hears; none if it hears nothing."""

_Key = tuple[int, int, Vector | None]


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
        self._known: set[_Key] = set()
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
        key = _key_of(position, loudest)
        if key not in self._known:
            self._known.add(key)
            self._answers.clear()
            self._buckets.setdefault(_bucket_of(position, self._bucket_m), []).append((position, loudest))

    def add_all(self, heard: Heard) -> None:
        """Note what several robots hear from where they are, in this order."""
        notes = _notes(heard, self._bucket_m)
        fresh = notes.keys.difference(self._known)
        if fresh:
            self._known |= fresh
            self._answers.clear()
            for _, bucket, note in sorted([notes.of[key] for key in fresh]):
                self._buckets.setdefault(bucket, []).append(note)

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


class _Notes(NamedTuple):
    """What several robots hear, by place. Of those at one place the first counts: its index, its bucket and itself."""

    keys: frozenset[_Key]
    of: dict[_Key, tuple[int, tuple[int, int], tuple[Vector, Vector | None]]]


# All robots of one process that hear the same reports ask for these.
@functools.lru_cache(maxsize=256)
def _notes(heard: Heard, bucket_m: float) -> _Notes:
    of: dict[_Key, tuple[int, tuple[int, int], tuple[Vector, Vector | None]]] = {}
    for i, (position, loudest) in enumerate(heard):
        of.setdefault(_key_of(position, loudest), (i, _bucket_of(position, bucket_m), (position, loudest)))
    return _Notes(frozenset(of), of)


def _key_of(position: Vector, loudest: Vector | None) -> _Key:
    return round(position[0] / _SAME_PLACE_M), round(position[1] / _SAME_PLACE_M), loudest


def _bucket_of(place: Vector, bucket_m: float) -> tuple[int, int]:
    return math.floor(place[0] / bucket_m), math.floor(place[1] / bucket_m)
