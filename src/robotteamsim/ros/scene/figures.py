"""People in the 3D scene, lying or upright: firefighters by coat and helmet, victims by the colour of their state."""

import math
from collections.abc import Iterator
from typing import NamedTuple

from visualization_msgs.msg import Marker

from robotteamsim import palette
from robotteamsim.ros.scene.shapes import Colour, Position, colour, marker

SKIN = colour(palette.SKIN)
COAT, STRIPE, HELMET = colour(palette.TURNOUT_COAT), colour(palette.REFLECTIVE), colour(palette.HELMET)
LARGER = 1.45
"""Upright people are drawn larger by this factor: from above, one sees little of them."""
HIGHEST_M = 1.9 * LARGER
"""Height of the helmet of an upright figure [m]."""
CLEAR_M = 1.9
"""Distance from an upright figure at which texts do not touch it in the default view [m]."""
MAX_PARTS = 12
"""Of one figure, so that ids of markers differ."""


class _Part(NamedTuple):
    """One part of a figure: its place along and across the body and above the floor, and its size [m]."""

    kind: int
    tint: Colour | None
    along: float
    across: float
    z: float
    size: Position


_LYING = (  # a figure of 1.75 m, of spheres; None is the colour of the clothes
    _Part(Marker.SPHERE, SKIN, 0.72, 0.0, 0.13, (0.26, 0.24, 0.26)),
    _Part(Marker.SPHERE, None, 0.22, 0.0, 0.15, (0.85, 0.52, 0.3)),
    _Part(Marker.SPHERE, None, 0.28, 0.36, 0.08, (0.62, 0.13, 0.13)),
    _Part(Marker.SPHERE, None, 0.28, -0.36, 0.08, (0.62, 0.13, 0.13)),
    _Part(Marker.SPHERE, None, -0.5, 0.13, 0.1, (0.95, 0.18, 0.18)),
    _Part(Marker.SPHERE, None, -0.5, -0.13, 0.1, (0.95, 0.18, 0.18)),
)
_UPRIGHT = (
    _Part(Marker.SPHERE, SKIN, 0.0, 0.0, 1.6, (0.28, 0.26, 0.3)),
    _Part(Marker.CYLINDER, None, 0.0, 0.0, 1.13, (0.32, 0.5, 0.66)),
    _Part(Marker.SPHERE, None, 0.05, 0.33, 1.12, (0.18, 0.18, 0.72)),
    _Part(Marker.SPHERE, None, 0.05, -0.33, 1.12, (0.18, 0.18, 0.72)),
    _Part(Marker.CYLINDER, None, 0.06, 0.13, 0.4, (0.2, 0.2, 0.8)),
    _Part(Marker.CYLINDER, None, -0.06, -0.13, 0.4, (0.2, 0.2, 0.8)),
)
_EQUIPMENT = (
    _Part(Marker.CYLINDER, HELMET, 0.0, 0.0, 1.68, (0.58, 0.52, 0.05)),
    _Part(Marker.SPHERE, HELMET, 0.0, 0.0, 1.7, (0.42, 0.4, 0.4)),
    _Part(Marker.CYLINDER, STRIPE, 0.0, 0.0, 1.28, (0.35, 0.53, 0.09)),
    _Part(Marker.CYLINDER, STRIPE, 0.0, 0.0, 0.92, (0.35, 0.53, 0.09)),
    _Part(Marker.CYLINDER, STRIPE, -0.26, 0.0, 1.2, (0.18, 0.18, 0.5)),
)


def lying(index: int, place_m: tuple[float, float], tint: Colour, raised_m: float = 0.0) -> Iterator[Marker]:
    """Yield a victim on their back, each in another direction. Args: raised_m: above the floor, if carried."""
    yield from _figure("victims", index, (*place_m, raised_m), 0.6 + 1.9 * index, _LYING, tint, 1.0)


def upright(index: int, place_m: tuple[float, float], tint: Colour) -> Iterator[Marker]:
    """Yield a victim who stands or walks."""
    yield from _figure("victims", index, (*place_m, 0.0), 0.6 + 1.9 * index, _UPRIGHT, tint, LARGER)


def firefighter(robot_id: int, place_m: tuple[float, float], yaw_rad: float) -> Iterator[Marker]:
    """Yield a person in a coat with reflective stripes, with helmet and breathing apparatus."""
    yield from _figure("firefighters", robot_id, (*place_m, 0.0), yaw_rad, (*_UPRIGHT, *_EQUIPMENT), COAT, LARGER)


def _figure(
    namespace: str, number: int, at: Position, yaw_rad: float, parts: tuple[_Part, ...], clothes: Colour, size: float
) -> Iterator[Marker]:
    cos, sin = size * math.cos(yaw_rad), size * math.sin(yaw_rad)
    for k, part in enumerate(parts):
        x = at[0] + cos * part.along - sin * part.across
        y = at[1] + sin * part.along + cos * part.across
        scale = (size * part.size[0], size * part.size[1], size * part.size[2])
        yield marker(
            namespace,
            MAX_PARTS * number + k,
            part.kind,
            part.tint or clothes,
            position=(x, y, at[2] + size * part.z),
            yaw_rad=yaw_rad,
            scale=scale,
        )
