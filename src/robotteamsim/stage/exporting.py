"""Exports a scenario as a Stage world file and its bitmap."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.drives import AnyDrive
from robotteamsim.scenario.floor_plan import Block, Door, Wall
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.plan import OCCUPIED, Corners, grid_shape, occupancy_grid
from robotteamsim.scenario.plan_export import RESOLUTION_M
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import Odometry, PlacedRobot, Robot
from robotteamsim.scenario.sensors import Laser
from robotteamsim.world.placement import check_places, placed_robots

MAX_PIXELS = 100_000_000
"""Largest bitmap: Stage examines every pixel and needs minutes for this many."""

_RAYTRACE_M = 0.02
"""Cell size of Stage's ray tracing, its default."""

_DISC_CORNERS = 16
_COLORS = ("red", "blue", "green", "orange", "purple", "cyan", "magenta", "gold")


@dataclass(frozen=True, slots=True)
class StageExport:
    """The text of a world file, its bitmap (PNG), and notes on what Stage does not support, one line each."""

    world: str
    bitmap: bytes
    notes: tuple[str, ...]


def export_world(scenario: Scenario, bitmap: str, resolution_m: float = RESOLUTION_M) -> StageExport:
    """Return a scenario in the form that Stage 4 and stage_ros read.

    Walls and closed doors become a bitmap, cropped to the solid cells as in Stage, so that no cell moves. Every robot
    becomes a position model, in id order, so stage_ros calls them robot_0, ... Its rangers are its laser, additional
    lasers and sonars. Objects become models that do not move.

    Args:   bitmap: the name of the PNG, relative to the world file. resolution_m: edge of a pixel.
    Raises: ScenarioError: the plan has no solid, or a robot is a car. PlacementError: a robot or object has no room.
    """
    check_places(scenario)
    robots = placed_robots(scenario)
    if any(robot.drive.kind == "car" for robot in robots):
        text = "robots.drive.kind: in Stage, the turn of a car is a steering angle; expected another drive"
        raise ScenarioError(f"{scenario.name}: {text}")
    image = _bitmap(scenario, resolution_m)
    kinds = list(dict.fromkeys(_kind(robot) for robot in robots))
    lowest_m = min(robot.height_m for robot in robots)
    lines = [
        f"# {scenario.name}: written by `robotteamsim plan export-stage`",
        f'name "{_text(scenario.name)}"',
        f"interval_sim {_number(scenario.run.step_s * 1000.0)}  # a step [ms]: commands, scans and odometry",
        f"quit_time {_number(scenario.mission.time_limit_s)}  # [s]",
        f"resolution {_number(_RAYTRACE_M)}  # of Stage's rays and collisions [m]",
        "",
        *_floor_plan(scenario, bitmap, image),
    ]
    for number, kind in enumerate(kinds):
        lines += ["", *_defined(f"robot_kind_{number}", kind, lowest_m, scenario.run.step_ns)]
    for obj in scenario.objects:
        lines += ["", *_object(obj)]
    lines.append("")
    for i, robot in enumerate(robots):
        x, y, yaw = robot.start_pose
        name = f"robot_kind_{kinds.index(_kind(robot))}"
        color = _COLORS[i % len(_COLORS)]
        lines.append(f'{name}( pose {_tuple(x, y, 0.0, math.degrees(yaw))} name "robot_{i}" color "{color}" )')
    return StageExport("\n".join(lines) + "\n", image.png, _notes(scenario, robots))


@dataclass(frozen=True, slots=True)
class _Bitmap:
    """The solid cells of a plan as a PNG; its size and centre in `map` [m]."""

    png: bytes
    size_m: tuple[float, float]
    center_m: tuple[float, float]


def _bitmap(scenario: Scenario, resolution_m: float) -> _Bitmap:
    """Return the bitmap of a plan. Raises: ScenarioError: it is too large, or the plan has no solid."""
    import cv2

    pixels = math.prod(grid_shape(scenario.plan, resolution_m))
    if pixels > MAX_PIXELS:
        text = f"has {pixels} pixels of {resolution_m:g} m; expected at most {MAX_PIXELS}"
        raise ScenarioError(f"{scenario.name}: plan: {text}")
    grid = occupancy_grid(scenario.plan, resolution_m)
    solid = grid.cells == OCCUPIED
    if not solid.any():
        raise ScenarioError(f"{scenario.name}: plan: has no wall, block or closed door for a bitmap")
    rows, columns = np.flatnonzero(solid.any(axis=1)), np.flatnonzero(solid.any(axis=0))
    low, high = (int(columns[0]), int(rows[0])), (int(columns[-1]) + 1, int(rows[-1]) + 1)
    grey = np.where(solid[low[1] : high[1], low[0] : high[0]], 0, 255).astype(np.uint8)
    (origin_x, origin_y), (low_x, low_y), (high_x, high_y) = grid.origin_m, low, high
    return _Bitmap(
        cv2.imencode(".png", np.flipud(grey))[1].tobytes(),
        ((high_x - low_x) * resolution_m, (high_y - low_y) * resolution_m),
        (origin_x + 0.5 * (low_x + high_x) * resolution_m, origin_y + 0.5 * (low_y + high_y) * resolution_m),
    )


def _notes(scenario: Scenario, robots: Sequence[PlacedRobot]) -> tuple[str, ...]:
    notes = []
    if any(robot.odometry != _EXACT for robot in robots):
        notes.append("odometry: drifts by the alphas here, but by a fixed share of every motion in Stage: odom_error")
    if scenario.plan.doors:
        notes.append("doors: stay as they are at the start, closed ones as walls: Stage has no doors")
    if scenario.objects:
        notes.append("objects: cannot be pushed in Stage")
    if any(laser.no_return == "inf" for robot in robots for laser in (robot.laser, *robot.lasers)):
        notes.append("laser.no_return: Stage returns range_max where nothing is hit, never inf")
    if any(robot.sonars for robot in robots):
        notes.append("sonars: Stage has no cones; a ranger reports every ray, the shortest is the sonar's")
    if any(robot.mounts for robot in robots):
        notes.append("lasers, sonars: stage_ros numbers the scans of such a robot; the first laser's is base_scan_0")
    # Sensors that a robot has at most once are None by default; Stage has none of them.
    for key in (key for key, field in Robot.model_fields.items() if field.default is None):
        if any(getattr(robot, key) is not None for robot in robots):
            notes.append(f"{key}: omitted: stage_ros has no such sensor")
    if len(robots) == 1:
        notes.append("robots: stage_ros omits robot_0/ in the names of topics if there is only one robot")
    return tuple(notes)


_EXACT = Odometry(alpha1=0.0, alpha2=0.0, alpha3=0.0, alpha4=0.0)


def _kind(robot: PlacedRobot) -> PlacedRobot:
    """Return a robot without what differs between robots of one kind."""
    return robot.model_copy(update={"start_pose": (0.0, 0.0, 0.0)})


def _item(head: str, *lines: str) -> list[str]:
    """Return the lines of `head( ... )`."""
    return [head, "(", *(f"  {line}" for line in lines), ")"]


def _floor_plan(scenario: Scenario, file: str, image: _Bitmap) -> list[str]:
    elements: tuple[Wall | Block | Door, ...] = (*scenario.plan.walls, *scenario.plan.blocks, *scenario.plan.doors)
    height_m = max(element.height_m for element in elements)
    return _item(
        "model",
        'name "floorplan"',
        f'bitmap "{_text(file)}"',
        f"size {_tuple(*image.size_m, height_m)}",
        f"pose {_tuple(*image.center_m, 0.0, 0.0)}",
        'color "gray30"',
        *("gui_move 0", "gui_outline 0", "gripper_return 0", "fiducial_return 0"),
    )


def _object(obj: MovableObject) -> list[str]:
    x, y, yaw = obj.pose
    size = obj.size_m or (2.0 * obj.reach_m, 2.0 * obj.reach_m)
    return _item(
        "model",
        f'name "{_text(obj.name)}"',
        f"size {_tuple(*size, obj.height_m)}",
        *_outline(obj.corners_m or _disc(obj.reach_m)),
        f"pose {_tuple(x, y, 0.0, math.degrees(yaw))}",
        f'color "{"brown" if obj.kind == "box" else "gray50"}"',
    )


def _disc(radius_m: float) -> Corners:
    angles = [2.0 * math.pi * i / _DISC_CORNERS for i in range(_DISC_CORNERS)]
    return tuple((radius_m * math.cos(angle), radius_m * math.sin(angle)) for angle in angles)


def _outline(corners: Corners) -> list[str]:
    points = (f"  point[{i}] {_tuple(x, y)}" for i, (x, y) in enumerate(corners))
    return [f"block( points {len(corners)}", *points, "  z [ 0 1 ]", ")"]


def _body(robot: PlacedRobot) -> list[str]:
    """Return size, origin and outline of a body; Stage stretches blocks to the size, around the origin."""
    corners = robot.corners_m or _disc(robot.radius_m)
    low, high = ([pick(axis) for axis in zip(*corners, strict=True)] for pick in (min, max))
    size = [b - a for a, b in zip(low, high, strict=True)]
    middle = [0.5 * (a + b) for a, b in zip(low, high, strict=True)]
    origin = f"origin {_tuple(*middle, 0.0, 0.0)}" if robot.footprint_m else "# a disc"
    return [f"size {_tuple(*size, robot.height_m)}", origin, *_outline(corners)]


def _defined(name: str, robot: PlacedRobot, lowest_m: float, step_ns: int) -> list[str]:
    """Return the definition of a kind of robot.

    Args: lowest_m: height of the lowest robot; rays are below it, so that robots detect each other as they do here.
    """
    return _item(
        f"define {name} position",
        *_body(robot),
        "gui_nose 1",
        _update(step_ns),
        f"mass {_number(robot.mass_kg)}",
        *_drive(robot.drive),
        *_odometry(robot.odometry),
        *_rangers(robot, lowest_m, step_ns),
    )


def _drive(drive: AnyDrive) -> list[str]:
    assert drive.kind != "car"
    aside = drive.max_speed_mps if drive.kind == "omni" else 0.0
    aside_change = drive.max_acceleration_mps2 if drive.kind == "omni" else 0.0
    return [
        f'drive "{"omni" if drive.kind == "omni" else "diff"}"',
        f"velocity_bounds {_limits(drive.max_speed_mps, aside, drive.max_turn_radps)}",
        f"acceleration_bounds {_limits(drive.max_acceleration_mps2, aside_change, drive.max_turn_acceleration_radps2)}",
    ]


def _limits(ahead: float, aside: float, turn_rad: float) -> str:
    turn = math.degrees(turn_rad)
    return _tuple(-ahead, ahead, -aside, aside, 0.0, 0.0, -turn, turn)


def _odometry(odometry: Odometry) -> list[str]:
    if odometry == _EXACT:
        return ['localization "gps"']
    # `import-stage` reads alpha1 and alpha3 back.
    share, turn_share = math.sqrt(odometry.alpha3), math.degrees(math.sqrt(odometry.alpha1))
    return ['localization "odom"', f"odom_error {_tuple(share, share, 0.0, turn_share)}"]


@dataclass(frozen=True, slots=True)
class _Beams:
    """The beams of a laser or sonar; mount: pose of the middle one in base_link."""

    name: str
    mount: tuple[float, float, float]
    height_m: float
    range_min_m: float
    range_max_m: float
    fov_rad: float
    samples: int
    noise_m: float
    interval_ns: int


def _rangers(robot: PlacedRobot, lowest_m: float, step_ns: int) -> list[str]:
    """Return the first laser, the additional lasers and the sonars, in this order."""
    beams = [_laser(robot.laser, "", (robot.laser.forward_m, 0.0, 0.0), step_ns)]
    for laser in robot.lasers:
        mount = (laser.forward_m, laser.left_m, laser.yaw_rad)
        beams.append(_laser(laser, laser.name, mount, laser.every_steps * step_ns))
    for sonar in robot.sonars:
        # `import-stage` recognises sonars by their names.
        name = sonar.name if "sonar" in sonar.name else f"sonar_{sonar.name}"
        mount, ranges_m = (sonar.forward_m, sonar.left_m, sonar.yaw_rad), (sonar.range_min_m, sonar.range_max_m)
        opening = sonar.opening_rad, sonar.rays
        beams.append(_Beams(name, mount, sonar.height_m, *ranges_m, *opening, sonar.noise_m, step_ns))
    return [line for each in beams for line in _ranger(each, robot.height_m, lowest_m)]


def _laser(laser: Laser, name: str, mount: tuple[float, float, float], interval_ns: int) -> _Beams:
    middle_rad = 0.5 * (laser.angle_min_rad + laser.angle_max_rad)
    return _Beams(
        name,
        mount=(mount[0], mount[1], mount[2] + middle_rad),
        height_m=laser.height_m,
        range_min_m=laser.range_min_m,
        range_max_m=laser.range_max_m,
        fov_rad=laser.angle_max_rad - laser.angle_min_rad,
        samples=laser.beams,
        noise_m=laser.noise_m,
        interval_ns=interval_ns,
    )


def _ranger(beams: _Beams, robot_m: float, lowest_m: float) -> list[str]:
    """Args: robot_m, lowest_m: heights of the robot and of the lowest robot."""
    # stage_ros derives tf from the pose of the ranger, but rays start at that of its sensor: the ranger has the true
    # height, and the sensor is low enough to detect robots.
    ray_m = beams.height_m if beams.height_m < 0.9 * lowest_m else 0.5 * lowest_m
    sensor = _item(
        "sensor",
        f"pose {_tuple(0.0, 0.0, ray_m - beams.height_m, 0.0)}",
        "size [ 0.02 0.02 0 ]",
        f"range {_tuple(beams.range_min_m, beams.range_max_m)}",
        f"fov {_number(math.degrees(beams.fov_rad))}",
        f"samples {beams.samples}",
        *([f"noise {_tuple(beams.noise_m**2, 0.0, 0.0)}  # a variance [m^2]"] if beams.noise_m else []),
    )
    x, y, yaw = beams.mount
    pose = f"pose {_tuple(x, y, beams.height_m - robot_m, math.degrees(yaw))}"
    name = [f'name "{beams.name}"'] if beams.name else []
    return _item("ranger", *name, pose, _update(beams.interval_ns), *sensor)


def _update(interval_ns: int) -> str:
    """Return the property; Stage expects whole milliseconds."""
    return f"update_interval {max(interval_ns // 1_000_000, 1)}"


def _tuple(*values: float) -> str:
    return f"[ {' '.join(map(_number, values))} ]"


def _number(value: float) -> str:
    """Return a number for Stage: digits, a decimal point and a sign, no exponent."""
    text = f"{value:.12f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def _text(text: str) -> str:
    """Return a text without characters that would end it in a world file."""
    return text.replace('"', "'").replace("\n", " ")
