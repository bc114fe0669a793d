"""Places for texts next to what they name, where they cover neither walls nor each other."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

Point = tuple[float, float]

SIDES = np.array(
    [(0.0, -1.0), (0.0, 1.0), (1.0, 0.0), (-1.0, 0.0)]
    + [(x, y) for x in (0.5, -0.5, 0.8, -0.8, 1.0, -1.0) for y in (-1.0, 1.0)]
    + [(0.0, -2.0), (0.0, 2.0), (2.0, 0.0), (-2.0, 0.0)]
)
"""Sides of its anchor on which a text can be, best first: below, above, right, left, between, and farther away."""

_PREFERENCE = 0.01 * np.arange(len(SIDES))

_NOT_FREE, _TOUCHES = 0.3, 0.01
"""Cost of covering more than this share of the text's area: any side that is free is better, also a farther one."""


@dataclass(frozen=True, slots=True)
class Text:
    """A text to place.

    anchor_m: what it names [m].
    half_m:   half its width and height [m].
    clear_m:  distance from the anchor that it leaves free.
    """

    anchor_m: Point
    half_m: Point
    clear_m: float


@dataclass(frozen=True, slots=True)
class Spot:
    """The place of a text: its middle, and half its width and height."""

    middle_m: Point
    half_m: Point

    @property
    def box(self) -> shapely.Polygon:
        """The area that the text covers."""
        (x, y), (half_x, half_y) = self.middle_m, self.half_m
        return shapely.box(x - half_x, y - half_y, x + half_x, y + half_y)


def place(texts: Sequence[Text], taken: Sequence[shapely.Geometry], inside: shapely.Geometry) -> list[Spot]:
    """Return a spot for each text, in order: within an area, off what is taken and off the texts before it.

    Where no side is free, the side is used that covers least.
    """
    spots: list[Spot] = []
    covered = shapely.union_all(list(taken))
    for text in texts:
        written = shapely.union_all([spot.box for spot in spots])
        spots.append(_best(text, covered, written, inside))
    return spots


def _best(text: Text, taken: shapely.Geometry, written: shapely.Geometry, inside: shapely.Geometry) -> Spot:
    half_x, half_y = text.half_m
    x, y = (np.array(text.anchor_m) + SIDES * (text.clear_m + np.array(text.half_m))).T
    boxes = shapely.box(x - half_x, y - half_y, x + half_x, y + half_y)
    cost = _PREFERENCE.copy()
    covered_m2 = shapely.area(shapely.intersection(boxes, taken))
    overwritten_m2 = shapely.area(shapely.intersection(boxes, written))
    outside_m2 = shapely.area(shapely.difference(boxes, inside))
    bad = (covered_m2 + 3.0 * overwritten_m2 + 2.0 * outside_m2) / (4.0 * half_x * half_y)
    cost += bad + _NOT_FREE * (bad > _TOUCHES)
    side = int(np.argmin(cost))
    return Spot((float(x[side]), float(y[side])), text.half_m)
