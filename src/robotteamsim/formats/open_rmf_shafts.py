"""Finds the shafts of lifts in plans, as the importer of Open-RMF draws them."""

from __future__ import annotations

import cmath
import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import shapely

from robotteamsim.formats.open_rmf_file import SHAFT_M, WALL_M
from robotteamsim.formats.open_rmf_lifts import remaining
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.floor_plan import Wall

_FARTHEST_M = 10.0
"""From a stop to the corners of its shaft."""
_NARROWEST_M = 0.1
"""A narrower gap is not a door."""
_SAME_M = 1e-5
"""Corners that are closer are the same, for those of imported shafts have six digits; sizes have five."""


@dataclass(frozen=True)
class FoundShaft:
    """A rectangle of walls around a stop.

    middle: the stop, x + i y [m].
    half:   half its sides, x + i y, in its own frame [m].
    sides:  from where to where each has walls, from the middle of the side: above, right, below, left [m].
    walls:  their names.
    """

    middle: complex
    yaw_rad: float
    half: complex
    sides: tuple[tuple[tuple[float, float], ...], ...]
    walls: frozenset[str]

    @property
    def width_m(self) -> float:
        """Width of the cabin [m]."""
        return round(2.0 * (self.half.real - SHAFT_M), 5)

    @property
    def depth_m(self) -> float:
        """Depth of the cabin [m]."""
        return round(2.0 * (self.half.imag - SHAFT_M), 5)

    def is_like(self, other: FoundShaft) -> bool:
        """Whether another level has the same rectangle."""
        return abs(self.half - other.half) < _SAME_M and abs(self.yaw_rad - other.yaw_rad) < _SAME_M

    def is_hole(self, polygon: Sequence[Point]) -> bool:
        """Whether an opening is that of the shaft, which Open-RMF cuts out of floors by itself."""
        turn, x, y = cmath.exp(1j * self.yaw_rad), self.half.real, self.half.imag
        corners = [self.middle + turn * complex(*corner) for corner in ((x, y), (-x, y), (-x, -y), (x, -y))]
        own = shapely.Polygon([(z.real, z.imag) for z in corners])
        return bool(own.symmetric_difference(shapely.Polygon(polygon)).area < _SAME_M * own.length)

    def doors(self) -> Iterator[tuple[float, float, float, int]]:
        """Yield x and y of the doors on the sides of the cabin, their widths, and their sides."""
        for side, walls in enumerate(self.sides):
            half_m = self.half.real if side % 2 == 0 else self.half.imag
            for first, last in remaining(half_m, walls):
                if last - first < _NARROWEST_M:
                    continue
                along_m, width_m = round(0.5 * (first + last), 5) + 0.0, round(last - first, 5)
                far_m = (0.5 * self.depth_m, 0.5 * self.width_m, -0.5 * self.depth_m, -0.5 * self.width_m)[side]
                yield (along_m, far_m, width_m, side) if side % 2 == 0 else (far_m, along_m, width_m, side)


def found_shaft(stop: Point, walls: Sequence[Wall]) -> FoundShaft | None:
    """Return the smallest rectangle around a stop whose corners are all ends of walls along its sides; None: none."""
    middle = complex(*stop)
    near = [
        (wall.name, complex(*wall.start) - middle, complex(*wall.end) - middle)
        for wall in walls
        if abs(wall.thickness_m - WALL_M) < _SAME_M
    ]
    near = [wall for wall in near if max(abs(wall[1]), abs(wall[2])) < _FARTHEST_M]
    found: list[FoundShaft] = []
    for yaw_rad in {_yaw(end - start) for _, start, end in near}:
        turn = cmath.exp(-1j * yaw_rad)
        aligned = [wall for wall in near if _is_on_axis((wall[2] - wall[1]) * turn)]
        turned = [(name, start * turn, end * turn) for name, start, end in aligned]
        corners = {(round(abs(z.real), 6), round(abs(z.imag), 6)) for _, *ends in turned for z in ends}
        for half in itertools.starmap(complex, corners):
            if min(half.real, half.imag) > SHAFT_M and (shaft := _shaft(middle, yaw_rad, half, turned)):
                found.append(shaft)
    return min(found, key=lambda shaft: shaft.half.real * shaft.half.imag, default=None)


def _is_on_axis(along: complex) -> bool:
    return min(abs(along.real), abs(along.imag)) < _SAME_M


def _yaw(direction: complex) -> float:
    """Return the angle of a rectangle with a side of a direction, 0 <= angle < pi / 2 [rad]."""
    yaw_rad = round(cmath.phase(direction) % (0.5 * math.pi), 6)
    return 0.0 if yaw_rad >= round(0.5 * math.pi, 6) else yaw_rad


def _shaft(
    middle: complex, yaw_rad: float, half: complex, walls: Sequence[tuple[str, complex, complex]]
) -> FoundShaft | None:
    """Return a rectangle if its corners are ends of walls on its sides. Args: walls: in its frame."""
    sides: list[list[tuple[float, float]]] = [[], [], [], []]
    names, ends = set(), []
    for side, pieces in enumerate(sides):
        # Turned so that the side is above.
        turn = 1j**side
        high_m, wide_m = (half.imag, half.real) if side % 2 == 0 else (half.real, half.imag)
        for name, *points in walls:
            a, b = (point * turn for point in points)
            is_on = all(abs(z.imag - high_m) < _SAME_M and abs(z.real) < wide_m + _SAME_M for z in (a, b))
            if is_on:
                # Sides on the right and below run the other way, so that x and y grow along them.
                low_m, high = sorted((z.real if side in (0, 3) else -z.real) for z in (a, b))
                pieces.append((low_m, high))
                names.add(name)
                ends += points
    corners = [complex(x, y) for x in (half.real, -half.real) for y in (half.imag, -half.imag)]
    if not all(any(abs(end - corner) < 2.0 * _SAME_M for end in ends) for corner in corners):
        return None
    return FoundShaft(middle, yaw_rad, half, tuple(tuple(pieces) for pieces in sides), frozenset(names))
