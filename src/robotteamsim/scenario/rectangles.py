"""Polygons that are rectangles."""

from __future__ import annotations

import math
from dataclasses import dataclass

from robotteamsim.scenario.plan import Corners

_RIGHT_ANGLE = 1e-6
"""Largest cosine of an angle that counts as a right one."""


@dataclass(frozen=True, slots=True)
class Rectangle:
    """A rectangle on the floor: its middle, the direction of its first side, and both sides [m, m, rad]."""

    x: float
    y: float
    yaw: float
    length_m: float
    width_m: float

    def turned(self) -> Rectangle:
        """The same rectangle with its sides swapped."""
        return Rectangle(self.x, self.y, self.yaw + 0.5 * math.pi, self.width_m, self.length_m)

    @property
    def ends_m(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """The ends of its middle line, along the first side [m]."""
        along_x, along_y = 0.5 * self.length_m * math.cos(self.yaw), 0.5 * self.length_m * math.sin(self.yaw)
        start, end = (self.x - along_x, self.y - along_y), (self.x + along_x, self.y + along_y)
        return in_micrometres(start), in_micrometres(end)


def in_micrometres(point: tuple[float, float]) -> tuple[float, float]:
    """Return a point without digits from rounding."""
    return round(point[0], 6) + 0.0, round(point[1], 6) + 0.0


def rectangle_of(corners: Corners) -> Rectangle | None:
    """Return four corners in order as a rectangle; its first side is from the first corner; None: they are not one."""
    if len(corners) != 4:
        return None
    (x0, y0), (x1, y1), (x2, y2), (x3, y3) = corners
    length_m, width_m = math.hypot(x1 - x0, y1 - y0), math.hypot(x3 - x0, y3 - y0)
    if min(length_m, width_m) <= 0.0:
        return None
    if max(abs(x0 + x2 - x1 - x3), abs(y0 + y2 - y1 - y3)) > _RIGHT_ANGLE * max(length_m, width_m):
        return None
    if abs((x1 - x0) * (x3 - x0) + (y1 - y0) * (y3 - y0)) > _RIGHT_ANGLE * length_m * width_m:
        return None
    return Rectangle(0.5 * (x0 + x2), 0.5 * (y0 + y2), math.atan2(y1 - y0, x1 - x0), length_m, width_m)
