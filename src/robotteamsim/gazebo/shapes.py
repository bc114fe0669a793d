"""Upright solids of one height: boxes, cylinders and prisms, with their inertia."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from robotteamsim.gazebo.elements import Element, element, material, pose, values
from robotteamsim.scenario.plan import Corners

_RIGHT_ANGLE = 1e-6
"""Largest cosine of an angle that counts as a right one."""


def in_micrometres(point: tuple[float, float]) -> tuple[float, float]:
    """Return a point without digits from rounding."""
    return round(point[0], 6) + 0.0, round(point[1], 6) + 0.0


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


def rectangle_of(corners: Corners) -> Rectangle | None:
    """Return four corners in order as a rectangle; its first side is from the first corner; None: they are not one."""
    if len(corners) != 4:
        return None
    points = np.array(corners)
    first, second = points[1] - points[0], points[2] - points[1]
    length_m, width_m = math.hypot(*first), math.hypot(*second)
    if min(length_m, width_m) <= 0.0:
        return None
    if np.abs(points[0] + points[2] - points[1] - points[3]).max() > _RIGHT_ANGLE * max(length_m, width_m):
        return None
    if abs(first @ second) > _RIGHT_ANGLE * length_m * width_m:
        return None
    x, y = points.mean(axis=0).tolist()
    return Rectangle(x, y, math.atan2(first[1], first[0]), length_m, width_m)


@dataclass(frozen=True, slots=True)
class Solid:
    """A footprint with vertical sides, from bottom_m to top_m in the frame of its link.

    Either a disc of radius_m around (x, y), or corners counter-clockwise [m].
    """

    bottom_m: float
    top_m: float
    corners: Corners = ()
    radius_m: float = 0.0
    x: float = 0.0
    y: float = 0.0

    @property
    def height_m(self) -> float:
        """Height [m]."""
        return self.top_m - self.bottom_m

    def collision(self, name: str, *surface: Element) -> Element:
        """Return its collision."""
        return element("collision", *self._placed(), *surface, name=name)

    def visual(self, name: str, colour: str) -> Element:
        """Return its visual."""
        return element("visual", *self._placed(), material(colour), name=name)

    def _placed(self) -> tuple[Element, Element]:
        """Return pose and geometry; in SDF, boxes and cylinders are around their middle, prisms above their base."""
        middle_m = 0.5 * (self.bottom_m + self.top_m)
        if not self.corners:
            cylinder = element("cylinder", values("radius", self.radius_m), values("length", self.height_m))
            return pose(self.x, self.y, middle_m), element("geometry", cylinder)
        found = rectangle_of(self.corners)
        if found:
            box = element("box", values("size", found.length_m, found.width_m, self.height_m))
            return pose(found.x, found.y, middle_m, found.yaw), element("geometry", box)
        points = [values("point", x, y) for x, y in self.corners]
        polyline = element("polyline", *points, values("height", self.height_m))
        return pose(0.0, 0.0, self.bottom_m), element("geometry", polyline)

    def inertial(self, mass_kg: float) -> Element:
        """Return mass and inertia around its middle; a polygon counts as the box around it."""
        x, y, height_m = self.x, self.y, self.height_m
        if self.corners:
            low, high = np.min(self.corners, axis=0), np.max(self.corners, axis=0)
            (x, y), (length_m, width_m) = (0.5 * (low + high)).tolist(), (high - low).tolist()
            moments = (width_m**2 + height_m**2, length_m**2 + height_m**2, length_m**2 + width_m**2)
        else:
            across = 3.0 * self.radius_m**2 + height_m**2
            moments = (across, across, 6.0 * self.radius_m**2)
        ixx, iyy, izz = (mass_kg * moment / 12.0 for moment in moments)
        inertia = [values("ixx", ixx), values("ixy", 0.0), values("ixz", 0.0)]
        inertia += [values("iyy", iyy), values("iyz", 0.0), values("izz", izz)]
        place = pose(x, y, 0.5 * (self.bottom_m + self.top_m))
        return element("inertial", place, values("mass", mass_kg), element("inertia", *inertia))
