"""Upright solids of one height: boxes, cylinders and prisms, with their inertia."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robotteamsim.gazebo.elements import Element, element, material, pose, values
from robotteamsim.scenario.plan import Corners, rectangle_of


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
