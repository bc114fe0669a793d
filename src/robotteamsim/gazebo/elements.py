"""The elements of SDF that several models share."""

import xml.etree.ElementTree as ET

from robotteamsim import palette

Element = ET.Element


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
