"""What several models of a world share: elements of SDF, upright solids, and names."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from dataclasses import dataclass

import numpy as np

from robotteamsim import palette
from robotteamsim.scenario.plan import Corners, rectangle_of

Element = ET.Element

FLOOR, WALLS, BLOCKS, PILLARS = (
    "robotteamsim_floor",
    "robotteamsim_walls",
    "robotteamsim_blocks",
    "robotteamsim_pillars",
)
"""Models of the floor plan; each wall, block or pillar is a link of one of them."""

DOOR, OBJECT, ROBOT = "door_", "object_", "robot_"
"""Prefixes of the models of doors, objects and robots."""

ROBOT_PLUGIN, WORLD_PLUGIN = "librobotteamsim_gazebo.so", "librobotteamsim_gazebo_world.so"

_NOT_IN_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_RESERVED = re.compile("__.*__")


def element(tag: str, *children: Element, text: str = "", **attributes: str) -> Element:
    """Return an element with its text or its children."""
    made = ET.Element(tag, attributes)
    made.text = text or None
    made.extend(children)
    return made


def values(tag: str, *numbers: float) -> Element:
    """Return an element that contains numbers."""
    return element(tag, text=" ".join(map(number_text, numbers)))


def flag(tag: str, value: bool) -> Element:
    """Return an element that contains true or false."""
    return element(tag, text="true" if value else "false")


def pose(x: float, y: float, z: float = 0.0, yaw: float = 0.0) -> Element:
    """Return the pose of an upright frame [m, m, m, rad]."""
    return values("pose", x, y, z, 0.0, 0.0, yaw)


def number_text(value: float) -> str:
    """Return a number with 12 digits; a number that is only 0 up to rounding is 0."""
    return f"{value if abs(value) > 1e-15 else 0.0:.12g}"


def text_of(root: Element) -> str:
    """Return an XML document."""
    ET.indent(root)
    return f'<?xml version="1.0"?>\n{ET.tostring(root, encoding="unicode")}\n'


def model(name: str, *children: Element) -> Element:
    """Return a model."""
    return element("model", *children, name=name)


def static_model(name: str, *children: Element) -> Element:
    """Return a model that never moves."""
    return model(name, flag("static", True), *children)


def material(colour: str) -> Element:
    """Return a material of one colour, given as a code of `palette`."""
    rgb = palette.rgb(colour)
    return element("material", values("ambient", *rgb, 1.0), values("diffuse", *rgb, 1.0))


def surface(mu: float | None = None, collide_bits: int | None = None) -> Element:
    """Return a surface.

    Args: mu: friction coefficient; in Gazebo, the lower one of two surfaces acts.
          collide_bits: bodies without a common bit do not touch; by default, all touch all.
    """
    made = element("surface")
    if mu is not None:
        made.append(element("friction", element("ode", values("mu", mu), values("mu2", mu))))
    if collide_bits is not None:
        made.append(element("contact", values("collide_bitmask", collide_bits)))
    return made


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


class Names:
    """Gives each name once, in the form that SDF allows; further ones get a number."""

    def __init__(self) -> None:
        self._given: dict[str, int] = {}
        """The last number of each name."""

    def unused(self, wanted: str) -> str:
        """Return a name for an element of SDF: the wanted one if it is allowed and unused, or one like it."""
        # SDF separates nested names by "::" and reserves __names__.
        base = _NOT_IN_XML.sub("_", wanted).replace("::", "_").strip() or "unnamed"
        if _RESERVED.fullmatch(base):
            base = base.strip("_") or "unnamed"
        name = base
        while name in self._given:
            self._given[base] += 1
            name = f"{base}_{self._given[base]}"
        self._given[name] = 1
        return name
