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
