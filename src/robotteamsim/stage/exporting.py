"""Exports a floor plan, or a scenario on it, as a Stage world file."""

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from robotteamsim.formats import Exported
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.plan import Corners
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.scenario.sensors import Laser, MountedLaser, Sonar
from robotteamsim.wording import counted

_DISC_CORNERS = 16

_HEAD = """\
unit_angle "radians"
resolution 0.02
define floor model( color "gray90" obstacle_return 0 ranger_return -1 gui_move 0 )
define wall model( color "gray30" gui_move 0 )
define pillar model( color "gray50" gui_move 0 )
define door model( color "brown" gui_move 0 )
define fireproof_door model( color "red" gui_move 0 )
define sonar ranger( )"""

_LOST = {
    *("bays", "material", "materials", "motion", "time_s", "angle_rad", "no_return", "max_steering_rate_radps"),
    *("gripper", "wheels", "cmd_vel_hold_s", "alpha2", "alpha4", "levels", "openings", "passages"),
}
"""Keys of plans and robots that a world file cannot contain."""


def export_world(plan: FloorPlan, scenario: Scenario | None = None, robots: Sequence[PlacedRobot] = ()) -> Exported:
    """Return a floor plan, or a scenario on it, as a world of Stage 4; `import_world` returns an equal one.

    Walls, blocks and doors are models of their shape; nothing hits or sees an open door. Equal robots share a
    definition. They are in id order, so that stage_ros calls them robot_0, robot_1, ...

    Args: robots: those of the scenario, with their start poses; those that are not present are omitted.
    """
    robots = [robot for robot in robots if robot.present]
    lines = [f"# {plan.name}: written by `robotteamsim plan export-stage`", _HEAD, *_solids(plan)]
    if scenario is not None:
        lines += [f"name {_text(scenario.name)}", f"quit_time {_number(scenario.mission.time_limit_s)}"]
        lines += [f"interval_sim {_number(1000.0 * scenario.run.step_s)}"]
    kinds = [robot.model_copy(update={"start_pose": (0.0, 0.0, 0.0)}) for robot in robots]
    for i, kind in enumerate(dict.fromkeys(kinds)):
        assert scenario is not None
        robot_lines = _robot(kind, min(robot.height_m for robot in robots), 1000.0 * scenario.run.step_s)
        lines += [f"define robot_kind_{i} position(", *robot_lines, ")"]
    names = {kind: f"robot_kind_{i}" for i, kind in enumerate(dict.fromkeys(kinds))}
    for i, (robot, kind) in enumerate(zip(robots, kinds, strict=True)):
        x, y, yaw = robot.start_pose
        lines.append(f'{names[kind]}( name "robot_{i}" pose {_tuple(x, y, 0.0, yaw)} )')
    summary = counted(len(robots), "robot") if scenario else "no robot"
    return Exported("\n".join(lines) + "\n", summary, tuple(_notes(plan, scenario, robots)))


def _notes(plan: FloorPlan, scenario: Scenario | None, robots: Sequence[PlacedRobot]) -> Iterator[str]:
    given = [plan.model_dump(exclude_defaults=True), *(robot.model_dump(exclude_defaults=True) for robot in robots)]
    lost = sorted(_LOST & set(_keys(given)))
    lost += ["thickness_m of blocks"] if any(block.thickness_m for block in plan.blocks) else []
    if scenario is not None:
        exported = {"name", "plan", "robots", "mission", "run", "control"}
        lost += sorted(scenario.model_dump(exclude=exported, exclude_defaults=True))
        lost += sorted(scenario.mission.model_dump(exclude={"time_limit_s"}, exclude_defaults=True))
        kinds = {sensor.kind for robot in robots for sensor in robot.sensors if not isinstance(sensor, Laser | Sonar)}
        lost += [f"sensors of kind {kind}" for kind in sorted(kinds)]
    if lost:
        yield f"not in Stage: {', '.join(lost)}"
    if any(robot.drive.kind == "car" for robot in robots):
        yield "robots.drive: the turn of a command is a yaw rate here, a steering angle in Stage"
    if any(robot.odometry.alpha1 or robot.odometry.alpha3 for robot in robots):
        yield "robots.odometry: noise here; in Stage a fixed share of every motion, the roots of alpha1 and alpha3"


def _keys(value: Any) -> Iterator[str]:
    """Yield all keys of sections within each other."""
    for item in value.values() if isinstance(value, dict) else value if isinstance(value, list | tuple) else ():
        yield from _keys(item)
    yield from value if isinstance(value, dict) else ()


def _solids(plan: FloorPlan) -> Iterator[str]:
    low, high = np.array(plan.bounds.min), np.array(plan.bounds.max)
    yield _model("floor", plan.name, (*(high - low), 0.0), (*(0.5 * (low + high)), 0.0))
    for wall in plan.walls:
        yield _model("wall", wall.name, *_along(wall.start, wall.end, wall.thickness_m, wall.height_m))
    for block in plan.blocks:
        size, centre, outline = _outline(block.polygon)
        kind = "pillar" if block.kind == "pillar" else "model"
        yield _model(kind, block.name, (*size, block.height_m), (*centre, 0.0), outline)
    for door in plan.doors:
        kind = "fireproof_door" if door.kind == "fireproof" else "door"
        more = "" if door.closed else "obstacle_return 0 ranger_return -1"
        yield _model(kind, door.name, *_along(door.start, door.end, door.thickness_m, door.height_m), more)


def _along(start: Point, end: Point, *width_and_height_m: float) -> tuple[Sequence[float], Sequence[float]]:
    """Return size and pose of a box along a line."""
    (x0, y0), (x1, y1) = start, end
    size = (math.hypot(x1 - x0, y1 - y0), *width_and_height_m)
    return size, (0.5 * (x0 + x1), 0.5 * (y0 + y1), math.atan2(y1 - y0, x1 - x0))


def _outline(corners: Corners) -> tuple[np.ndarray, np.ndarray, str]:
    """Return size, centre and block of an outline; Stage stretches blocks to the size, around the centre."""
    low, high = np.min(corners, axis=0), np.max(corners, axis=0)
    points = " ".join(f"point[{i}] {_tuple(*corner)}" for i, corner in enumerate(corners))
    return high - low, 0.5 * (low + high), f"block( points {len(corners)} {points} z [ 0 1 ] )"


def _model(kind: str, name: str, size: Sequence[float], pose: Sequence[float], more: str = "") -> str:
    x, y, yaw = pose
    return f"{kind}( name {_text(name)} size {_tuple(*size)} pose {_tuple(x, y, 0.0, yaw)} {more})"


def _robot(robot: PlacedRobot, lowest_m: float, step_ms: float) -> Iterator[str]:
    """Yield the lines of a kind of robot. Args: lowest_m: height of the lowest robot."""
    angles = [2.0 * math.pi * i / _DISC_CORNERS for i in range(_DISC_CORNERS)]
    disc = tuple((robot.radius_m * math.cos(angle), robot.radius_m * math.sin(angle)) for angle in angles)
    size, centre, outline = _outline(robot.corners_m or disc)
    yield f"  size {_tuple(*size, robot.height_m)} origin {_tuple(*centre, 0.0, 0.0)} {outline}"
    yield f"  mass {_number(robot.mass_kg)} gui_nose 1 update_interval {_number(step_ms)}"
    drive, odometry, turn_radps2 = robot.drive, robot.odometry, robot.drive.max_turn_radps
    if drive.kind == "car":
        yield f'  drive "car" wheelbase {_number(drive.wheelbase_m)}'
    else:
        yield f'  drive "{"omni" if drive.kind == "omni" else "diff"}"'
        turn_radps2 = drive.max_turn_acceleration_radps2
    limits = (
        ("velocity", drive.max_speed_mps, drive.max_turn_radps),
        ("acceleration", drive.max_acceleration_mps2, turn_radps2),
    )
    for what, ahead, turn in limits:
        aside = ahead if drive.kind == "omni" else 0.0
        yield f"  {what}_bounds {_tuple(-ahead, ahead, -aside, aside, 0.0, 0.0, -turn, turn)}"
    if odometry.alpha1 or odometry.alpha3:
        share = math.sqrt(odometry.alpha3)
        yield f'  localization "odom" odom_error {_tuple(share, share, 0.0, math.sqrt(odometry.alpha1))}'
    for sensor in (robot.laser, *robot.sensors):
        if isinstance(sensor, Laser | Sonar):
            yield _ranger(sensor, robot.height_m, min(0.5 * lowest_m, sensor.height_m), step_ms)


def _ranger(sensor: Laser | Sonar, top_m: float, ray_m: float, step_ms: float) -> str:
    """Return a ranger on a robot.

    stage_ros derives tf from the pose of the ranger, but rays start at that of its sensor.

    Args: top_m: of the robot. ray_m: height of the rays, below the tops of all robots, so that they see each other.
    """
    if isinstance(sensor, Sonar):
        kind, low_rad, high_rad, rays = "sonar", -0.5 * sensor.opening_rad, 0.5 * sensor.opening_rad, sensor.rays
    else:
        kind, low_rad, high_rad, rays = "ranger", sensor.angle_min_rad, sensor.angle_max_rad, sensor.beams
    if rays == 1:  # it points straight ahead in Stage
        low_rad, high_rad = 2.0 * low_rad - high_rad, high_rad
    yaw_rad = getattr(sensor, "yaw_rad", 0.0) + 0.5 * (low_rad + high_rad)
    name = f"name {_text(sensor.name)} " if isinstance(sensor, MountedLaser | Sonar) else ""
    pose = _tuple(sensor.forward_m, sensor.left_m, sensor.height_m - top_m, yaw_rad)
    interval = f"update_interval {_number(getattr(sensor, 'every_steps', 1) * step_ms)}"
    beams = f"range {_tuple(sensor.range_min_m, sensor.range_max_m)} fov {_number(high_rad - low_rad)} samples {rays}"
    below = f"pose {_tuple(0.0, 0.0, ray_m - sensor.height_m, 0.0)} size [ 0.02 0.02 0 ]"
    noise = f" noise {_tuple(sensor.noise_m**2, 0.0, 0.0)}" if sensor.noise_m else ""
    return f"  {kind}( {name}pose {pose} {interval} sensor( {below} {beams}{noise} ) )"


def _tuple(*values: float) -> str:
    return f"[ {' '.join(map(_number, values))} ]"


def _number(value: float) -> str:
    """Return a number for Stage, which reads digits, a point and a sign, but no exponent; all digits that it has."""
    return np.format_float_positional(value + 0.0, trim="-")


def _text(text: str) -> str:
    """Return a text in quotes, without characters that would end it."""
    return '"' + text.replace('"', "'").replace("\n", " ") + '"'
