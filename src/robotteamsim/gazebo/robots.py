"""Robots as models: a body, wheels, the laser, and the plugin that drives them."""

import math
from typing import Literal

import shapely

from robotteamsim.gazebo.elements import Element, element, flag, material, model, pose, surface, values
from robotteamsim.gazebo.names import ROBOT_PLUGIN
from robotteamsim.gazebo.shapes import Solid
from robotteamsim.palette import INK
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.scenario.sensors import Laser

DriveKind = Literal["velocity", "wheels"]
"""The body has the velocity of the command [dissertation, Appendix 1], or its wheels turn."""

_ABOVE_LASER_M = 0.02
"""Bodies reach this far above their lasers, so that robots see each other as they do here."""

_CLEARANCE_M = 0.01
"""Below a body without wheels: friction with the floor would slow it."""

_DISC_RADIUS_M, _DISC_HEIGHT_M = 0.05, 0.03
"""Of the disc that shows a laser."""

_WHEEL_SHARE = 0.1
"""Of the mass of a robot, for both wheels."""

_CASTER_PLACE = 0.7
"""Of a caster, as a share of the distance from base_link to the front or the back of the body."""


def has_wheels(robot: PlacedRobot, drive: DriveKind) -> bool:
    """Whether a robot drives with wheels: only differential drives can."""
    return drive == "wheels" and robot.drive.kind == "differential"


def robot_model(name: str, robot: PlacedRobot, drive: DriveKind, step_s: float, colour: str) -> Element:
    """Return the model of a robot; its frame is base_link, on the floor.

    Args: step_s: between two scans.
    """
    height_m = max(robot.height_m, robot.laser.height_m + _ABOVE_LASER_M)
    wheel_m = (robot.wheels.radius_m or min(0.05, 0.2 * height_m)) if has_wheels(robot, drive) else 0.0
    bottom_m = min(wheel_m, 0.5 * height_m) or min(_CLEARANCE_M, 0.1 * height_m)
    corners = robot.corners_m
    body = Solid(bottom_m, height_m, corners, 0.0 if corners else robot.radius_m)
    mass_kg = robot.mass_kg * (1.0 - _WHEEL_SHARE) if wheel_m else robot.mass_kg
    base = element(
        "link",
        body.inertial(mass_kg),
        body.collision("collision", surface(mu=0.0)),
        body.visual("visual", colour),
        name="base_link",
    )
    parts = [base]
    if wheel_m:
        base.extend(_casters(robot, 0.5 * bottom_m))
        for side, sign in (("left", 1.0), ("right", -1.0)):
            parts += _wheel(robot, side, sign * _wheel_offset_m(robot, wheel_m), wheel_m)
    base.append(_laser_disc(robot.laser, height_m))
    base.append(_ray_sensor(robot.laser, step_s))
    plugin = _plugin(robot, "wheels" if wheel_m else "velocity", step_s)
    x, y, yaw = robot.start_pose
    return model(name, pose(x, y, 0.0, yaw), *parts, plugin)


def _wheel_offset_m(robot: PlacedRobot, wheel_m: float) -> float:
    """Return the distance of the wheels from the middle, so that they are within the footprint [m]."""
    if not robot.corners_m:
        side_m = robot.radius_m
    else:
        axle = shapely.LineString([(0.0, -robot.reach_m), (0.0, robot.reach_m)])
        _, low, _, high = shapely.Polygon(robot.corners_m).intersection(axle).bounds
        side_m = min(-low, high)
    return max(side_m - 0.5 * wheel_m, 0.5 * side_m)


def _wheel(robot: PlacedRobot, side: str, y_m: float, radius_m: float) -> list[Element]:
    """Return a wheel and its joint."""
    half_m = 0.2 * radius_m
    disc = Solid(-half_m, half_m, radius_m=radius_m)
    # A cylinder of SDF is along z; the link is turned so that its z axis points to the left.
    link = element(
        "link",
        values("pose", 0.0, y_m, radius_m, -0.5 * math.pi, 0.0, 0.0),
        disc.inertial(0.5 * _WHEEL_SHARE * robot.mass_kg),
        disc.collision("collision", surface(mu=robot.wheels.friction)),
        disc.visual("visual", INK),
        name=f"{side}_wheel",
    )
    parts = element("parent", text="base_link"), element("child", text=f"{side}_wheel")
    axis = element("axis", values("xyz", 0.0, 0.0, 1.0))
    return [link, element("joint", *parts, axis, name=f"{side}_wheel_joint", type="revolute")]


def _casters(robot: PlacedRobot, radius_m: float) -> list[Element]:
    """Return two balls without friction below the front and the back of the body."""
    ahead = [x for x, _ in robot.corners_m] or [-robot.radius_m, robot.radius_m]
    made = []
    for name, x in (("front", max(ahead)), ("back", min(ahead))):
        place = pose(_CASTER_PLACE * x, 0.0, radius_m)
        ball = element("geometry", element("sphere", values("radius", radius_m)))
        made.append(element("collision", place, ball, surface(mu=0.0), name=f"{name}_caster"))
        made.append(element("visual", place, ball, material(INK), name=f"{name}_caster_visual"))
    return made


def _laser_disc(laser: Laser, height_m: float) -> Element:
    """Return a dark disc on the body, above the laser, so that one sees where the robot's front is."""
    disc = Solid(height_m, height_m + _DISC_HEIGHT_M, radius_m=_DISC_RADIUS_M, x=laser.forward_m, y=laser.left_m)
    return disc.visual("laser_visual", INK)


def _ray_sensor(laser: Laser, step_s: float) -> Element:
    """Return the laser; the plugin hides the robot's own body from it."""
    beams = element(
        "horizontal",
        element("samples", text=str(laser.beams)),
        values("resolution", 1.0),
        values("min_angle", laser.angle_min_rad),
        values("max_angle", laser.angle_max_rad),
    )
    limits = element("range", values("min", laser.range_min_m), values("max", laser.range_max_m))
    ray = element("ray", element("scan", beams), limits)
    if laser.noise_m:
        kind, mean = element("type", text="gaussian"), values("mean", 0.0)
        ray.append(element("noise", kind, mean, values("stddev", laser.noise_m)))
    place = pose(laser.forward_m, laser.left_m, laser.height_m)
    return element("sensor", place, values("update_rate", 1.0 / step_s), ray, name="base_scan", type="ray")


def _plugin(robot: PlacedRobot, drive: DriveKind, step_s: float) -> Element:
    settings = (
        element("drive", text=drive),
        _limits(robot),
        values("step_s", step_s),
        values("cmd_vel_hold_s", robot.cmd_vel_hold_s),
        element("no_return", text=robot.laser.no_return),
    )
    return element("plugin", *settings, name="robotteamsim", filename=ROBOT_PLUGIN)


def _limits(robot: PlacedRobot) -> Element:
    """Return the limits of the drive. A car has no limit of its steering rate in Gazebo."""
    drive = robot.drive
    limits = element(
        "limits",
        values("speed", drive.max_speed_mps),
        values("turn", drive.max_turn_radps),
        values("acceleration", drive.max_acceleration_mps2),
        flag("sideways", drive.kind == "omni"),
    )
    if drive.kind == "car":
        limits.append(values("turning_radius", drive.wheelbase_m / math.tan(drive.max_steering_rad)))
    else:
        limits.append(values("turn_acceleration", drive.max_turn_acceleration_radps2))
    return limits
