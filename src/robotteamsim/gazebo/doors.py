"""Doors as models: a leaf, and a joint to the world that lets it open.

The joint is at 0 in the state at the start, and at its other limit in the other state. The world plugin gets both.
"""

import math

from robotteamsim import palette
from robotteamsim.gazebo.elements import Element, element, flag, model, pose, surface, values
from robotteamsim.gazebo.shapes import Solid
from robotteamsim.scenario.floor_plan import Door

JOINT = "leaf_joint"

BELOW_FLOOR_M = 100.0
"""Where the leaf of an instant door is while the door is open: nothing meets it there."""

BUILDING_BITS, LEAF_BITS = 1, 2
"""A leaf touches robots and objects, but neither the walls at its ends nor the floor."""

_GAP_M = 0.005
"""At either end of a leaf."""
_ABOVE_FLOOR_M = 0.01
_MASS_KG_PER_M2 = 20.0
_DAMPING = 1.0


def door_model(name: str, door: Door) -> Element:
    """Return the model of a door, in its state at the start; its frame is at the hinge, with x along the leaf."""
    (x, y), (end_x, end_y) = door.start, door.end
    length_m, half_m = math.dist(door.start, door.end), 0.5 * door.thickness_m
    gap_m = min(_GAP_M, 0.1 * length_m)
    low, high = gap_m, length_m - gap_m
    corners = ((low, -half_m), (high, -half_m), (high, half_m), (low, half_m))
    leaf = Solid(min(_ABOVE_FLOOR_M, 0.1 * door.height_m), door.height_m, corners)
    link = element(
        "link",
        flag("gravity", False),
        leaf.inertial(_MASS_KG_PER_M2 * length_m * door.height_m),
        leaf.collision("collision", surface(collide_bits=LEAF_BITS)),
        leaf.visual("visual", palette.LIT_DOORS[door.kind]),
        name="leaf",
    )
    z, yaw = 0.0, math.atan2(end_y - y, end_x - x)
    if not door.closed:
        (shift_x, shift_y), yaw = door.leaf_shift_m, yaw + door.leaf_angle_rad
        x, y, z = x + shift_x, y + shift_y, -BELOW_FLOOR_M if door.motion == "instant" else 0.0
    return model(name, pose(x, y, z, yaw), link, _joint(door, length_m))


def _joint(door: Door, length_m: float) -> Element:
    """Return the joint; its frame is that of the leaf at the start."""
    if door.motion == "swing":
        kind, axis, opens_by = "revolute", (0.0, 0.0, 1.0), door.leaf_angle_rad
    elif door.motion == "slide":
        kind, axis, opens_by = "prismatic", (1.0, 0.0, 0.0), -length_m
    else:
        kind, axis, opens_by = "prismatic", (0.0, 0.0, 1.0), -BELOW_FLOOR_M
    other = opens_by if door.closed else -opens_by
    limit = element("limit", values("lower", min(other, 0.0)), values("upper", max(other, 0.0)))
    dynamics = element("dynamics", values("damping", _DAMPING))
    parts = element("parent", text="world"), element("child", text="leaf")
    return element("joint", *parts, element("axis", values("xyz", *axis), limit, dynamics), name=JOINT, type=kind)


def door_setting(name: str, door: Door) -> Element:
    """Return what the world plugin needs: model, joint, the state at the start, how long the leaf moves [s]."""
    parts = element("model", text=name), element("joint", text=JOINT), flag("closed", door.closed)
    return element("door", *parts, values("time_s", door.leaf_time_s))
