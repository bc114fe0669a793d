"""Rectangles, polygons and segments of a plan, and what is wrong with them."""

from __future__ import annotations

from collections.abc import Sequence

import shapely
from pydantic import Field, model_validator

from robotteamsim.scenario.base import Model, Point, wrong

MIN_SIDE_M = 0.01
MAX_SIDE_M = 1000.0
"""Grids of larger plans would not fit into memory."""

MAX_COORDINATE_M = 999_000.0
"""The exact sums of propagation are valid up to 1000 km; walls and cells extend a little beyond the bounds."""

MIN_AREA_M2 = 1e-6
"""Smallest area of a block: a square millimetre."""


class Bounds(Model):
    """The rectangle that the plan fills; nothing exists outside it."""

    min: Point = Field(default=(0.0, 0.0), description="lower left corner [m]")
    max: Point = Field(description="upper right corner [m]")

    @model_validator(mode="after")
    def _check(self) -> Bounds:
        for axis, (low, high) in zip("xy", zip(self.min, self.max, strict=True), strict=True):
            if not high > low:
                raise wrong("max", f"{axis} {high:g} is not above min, {low:g}")
            if high - low < MIN_SIDE_M:
                raise wrong("max", f"{axis} {high:g} is less than {MIN_SIDE_M:g} m from min, {low:g}")
            if high - low > MAX_SIDE_M:
                raise wrong("max", f"{axis} {high:g} is more than {MAX_SIDE_M:g} m from min, {low:g}")
            for key, value in (("min", low), ("max", high)):
                if abs(value) > MAX_COORDINATE_M:
                    raise wrong(key, f"{axis} {value:g} is more than {MAX_COORDINATE_M / 1000:g} km from 0")
        return self

    def contains(self, point: Point) -> bool:
        """Whether a point lies inside or on the border."""
        return all(low <= value <= high for low, value, high in zip(self.min, point, self.max, strict=True))

    def overlaps(self, other: Bounds) -> bool:
        """Whether two rectangles have a point in common."""
        return all(
            low <= other_high and other_low <= high
            for low, high, other_low, other_high in zip(self.min, self.max, other.min, other.max, strict=True)
        )

    def __str__(self) -> str:
        return f"[{self.min[0]:g}, {self.min[1]:g}] .. [{self.max[0]:g}, {self.max[1]:g}]"


def check_polygon(polygon: Sequence[Point]) -> None:
    """Raise a model's error for a polygon that encloses no area, or crosses itself."""
    outline = shapely.Polygon(polygon)
    if outline.convex_hull.area < MIN_AREA_M2:  # the signed area of an outline that crosses itself may be 0
        raise wrong("polygon", f"encloses no area: its corners lie on a line through {shown_point(polygon[0])}")
    if not outline.is_valid:
        raise wrong("polygon", f"crosses or touches itself at {_where_invalid(outline)}")
    if outline.area < MIN_AREA_M2:
        raise wrong("polygon", f"encloses no area at {shown_point(polygon[0])}")


def check_segment(start: Point, end: Point) -> None:
    """Raise a model's error for a segment without length."""
    if start == end:
        raise wrong("to", f"{shown_point(end)} is also the point of 'from'")


def shown_point(point: Point) -> str:
    """Return a point as messages show it: [2, 6.5]."""
    return f"[{point[0]:g}, {point[1]:g}]"


def _where_invalid(outline: shapely.Polygon) -> str:
    """Return the point at the end of what GEOS says: "Self-intersection[2 6.5]" gives "[2, 6.5]"."""
    x, y = shapely.is_valid_reason(outline).rpartition("[")[2].rstrip("]").split()
    return shown_point((float(x), float(y)))
