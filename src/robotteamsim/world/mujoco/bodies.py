"""Robots and objects as bodies of a MuJoCo model."""

from __future__ import annotations

from typing import Any

import mujoco

from robotteamsim.geometry import Pose
from robotteamsim.palette import BARREL, BOX, robot_colour
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.plan import Corners
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.scenario.sensors import MountedLaser
from robotteamsim.world.mujoco.appearance import add_dome
from robotteamsim.world.mujoco.cameras import add_camera, camera_name, cameras_of
from robotteamsim.world.mujoco.shapes import (
    BODIES,
    BODY_HITS,
    BODY_PRIORITY,
    OBJECT_GROUP,
    OBJECT_PRIORITY,
    ROBOT_GROUP,
    TOUCH_M,
    about_z,
    add_disc,
    add_prism,
    rgba,
)
from robotteamsim.world.mujoco.wheels import Chassis, add_wheels, wheel_mass_kg

_CENTRE_OF_MASS = 0.35
"""Height of a robot's centre of mass, as a fraction of its height: motors and batteries are low."""
_ABOVE_LASER_M = 0.05


def robot_name(robot_id: int) -> str:
    """Return the name of a robot's body."""
    return f"robot_{robot_id}"


def object_name(obj: MovableObject) -> str:
    """Return the name of an object's body."""
    return f"{obj.kind} {obj.name}"


def add_robot(
    spec: mujoco.MjSpec, robot_id: int, robot: PlacedRobot, pose: Pose, ground_m: float, friction: float
) -> None:
    """Add a robot at rest to the spec; the origin of its body is base_link, on the ground.

    Args:
        ground_m: height of the ground there.
        friction: of its body on anything but the ground.
    """
    name, chassis = robot_name(robot_id), Chassis.of(robot)
    body = _add_free_body(spec, name, pose, ground_m)
    keys = {"group": ROBOT_GROUP, "rgba": rgba(robot_colour(robot_id)), "mass": 0.0}
    _add_outline(
        spec,
        body,
        f"{name}/body",
        robot,
        (chassis.clearance_m, robot.height_m),
        contype=BODIES,
        conaffinity=BODY_HITS,
        priority=BODY_PRIORITY,
        friction=[friction, 0.0, 0.0],
        gap=TOUCH_M,
        **keys,
    )
    # A laser on top of a robot must see other robots, which have lasers on top, too.
    lasers = [sensor for sensor in robot.sensors if isinstance(sensor, MountedLaser)]
    top_m = max(laser.height_m for laser in (robot.laser, *lasers)) + _ABOVE_LASER_M
    if top_m > robot.height_m:
        _add_outline(spec, body, f"{name}/head", robot, (robot.height_m, top_m), contype=0, conaffinity=0, **keys)
    add_dome(body, name, robot, max(top_m, robot.height_m))
    for camera in cameras_of(robot):
        add_camera(body, camera_name(name, camera), camera)
    _set_mass(body, robot, chassis)
    add_wheels(spec, body, name, robot)


def add_object(spec: mujoco.MjSpec, obj: MovableObject, pose: Pose, ground_m: float) -> None:
    """Add an object at rest to the spec; the origin of its body is the centre of its base, on the ground."""
    name = object_name(obj)
    body = _add_free_body(spec, name, pose, ground_m)
    keys: dict[str, Any] = {
        "contype": BODIES,
        "conaffinity": BODY_HITS,
        "group": OBJECT_GROUP,
        "priority": OBJECT_PRIORITY,
        "friction": [obj.friction, 0.0, 0.0],
        "mass": obj.mass_kg,
        "rgba": rgba(BOX if obj.kind == "box" else BARREL),
    }
    if obj.radius_m:
        add_disc(body, name, obj.radius_m, 0.0, obj.height_m, **keys)
    else:
        add_prism(spec, body, name, obj.corners_m, 0.0, obj.height_m, **keys)


def _add_free_body(spec: mujoco.MjSpec, name: str, pose: Pose, ground_m: float) -> Any:
    body = spec.worldbody.add_body(name=name, pos=[pose.x_m, pose.y_m, ground_m], quat=about_z(pose.yaw_rad))
    body.add_freejoint(name=name)
    return body


def _add_outline(
    spec: mujoco.MjSpec, body: Any, name: str, robot: PlacedRobot, heights_m: tuple[float, float], **keys: Any
) -> None:
    if robot.footprint_m:
        add_prism(spec, body, name, robot.corners_m, *heights_m, **keys)
    else:
        add_disc(body, name, robot.radius_m, *heights_m, **keys)


def _set_mass(body: Any, robot: PlacedRobot, chassis: Chassis) -> None:
    """Set mass and inertia of a body without its wheels: those of the box around it."""
    mass_kg = robot.mass_kg - wheel_mass_kg(robot)
    x_m, y_m = _middle(robot.corners_m) if robot.footprint_m else (0.0, 0.0)
    if robot.drive.kind == "car":
        x_m = 0.5 * robot.drive.wheelbase_m
    length_m, width_m, height_m = chassis.front_m + chassis.back_m, 2.0 * chassis.half_width_m, robot.height_m
    squares = length_m**2, width_m**2, height_m**2
    body.mass = mass_kg
    body.ipos = [x_m, y_m, _CENTRE_OF_MASS * height_m]
    body.inertia = [mass_kg / 12.0 * (sum(squares) - square) for square in squares]
    body.explicitinertial = True


def _middle(corners: Corners) -> tuple[float, float]:
    xs, ys = zip(*corners, strict=True)
    return 0.5 * (min(xs) + max(xs)), 0.5 * (min(ys) + max(ys))
