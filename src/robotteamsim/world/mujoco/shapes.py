"""Geoms of MuJoCo for footprints with heights, and what collides with what."""

from __future__ import annotations

import math
from typing import Any

import mujoco

from robotteamsim.scenario.plan import Corners, rectangle_of

GROUND, BODIES = 1, 2
"""Bits of contype: the floor; walls, leaves, objects and the bodies of robots."""
WHEEL_HITS, BODY_HITS = GROUND, GROUND | BODIES
"""Bits of conaffinity: wheels touch only the floor."""

FLOOR_GROUP, BUILDING_GROUP, ROBOT_GROUP, OBJECT_GROUP, WHEEL_GROUP, LIGHT_GROUP = range(6)
"""Groups of geoms."""

TOUCH_M = 0.005
"""Bodies at this distance count as touching."""

OBJECT_PRIORITY, BODY_PRIORITY, WHEEL_PRIORITY, LEAF_PRIORITY = 1, 2, 3, 4
"""The friction of a contact is that of the geom with the higher priority; walls and floor have 0."""


def about_z(yaw_rad: float) -> list[float]:
    """Return the quaternion of a turn about the vertical axis."""
    return [math.cos(0.5 * yaw_rad), 0.0, 0.0, math.sin(0.5 * yaw_rad)]


def add_prism(
    spec: mujoco.MjSpec, body: Any, name: str, corners: Corners, bottom_m: float, top_m: float, **keys: Any
) -> None:
    """Add the prism over a convex polygon to a body of the spec. Args: keys: attributes of the geom."""
    rectangle, half_m = rectangle_of(corners), 0.5 * (top_m - bottom_m)
    if rectangle is None:
        vertices = [value for z_m in (bottom_m, top_m) for x_m, y_m in corners for value in (x_m, y_m, z_m)]
        spec.add_mesh(name=name, uservert=vertices)
        body.add_geom(name=name, type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, **keys)
        return
    body.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=[0.5 * rectangle.length_m, 0.5 * rectangle.width_m, half_m],
        pos=[rectangle.x, rectangle.y, bottom_m + half_m],
        quat=about_z(rectangle.yaw),
        **keys,
    )


def add_disc(body: Any, name: str, radius_m: float, bottom_m: float, top_m: float, **keys: Any) -> None:
    """Add an upright cylinder to a body of the spec. Args: keys: attributes of the geom."""
    half_m = 0.5 * (top_m - bottom_m)
    body.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_CYLINDER,
        size=[radius_m, half_m, 0.0],
        pos=[0.0, 0.0, bottom_m + half_m],
        **keys,
    )


def rgba(colour: str) -> list[float]:
    """Return a colour, a code of `palette`, as red, green, blue and opacity from 0 to 1."""
    return [int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5)] + [1.0]
