"""From a scenario to a Stage world file and its bitmap."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.drives import AnyDrive
from robotteamsim.scenario.floor_plan import Block, Door, Wall
from robotteamsim.scenario.plan import OCCUPIED, grid_shape, occupancy_grid
from robotteamsim.scenario.plan_export import RESOLUTION_M
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import Laser, Odometry, PlacedRobot

MAX_PIXELS = 100_000_000
"""Of a bitmap: what Stage, which looks at every pixel of it, still loads in minutes."""

_RAYTRACE_M = 0.02
"""Cell in which Stage traces rays: its own default."""

_DISC_CORNERS = 16
_COLORS = ("red", "blue", "green", "orange", "purple", "cyan", "magenta", "gold")


@dataclass(frozen=True, slots=True)
class StageExport:
    """A world file's text, the bitmap (PNG) that it names, and notes on what Stage does not have, one line each."""

    world: str
    bitmap: bytes
    notes: tuple[str, ...]


def export_world(scenario: Scenario, bitmap: str, resolution_m: float = RESOLUTION_M) -> StageExport:
    """Return a scenario as Stage 4 and stage_ros read it.

    Walls and closed doors become a bitmap, cut to the solid cells as Stage itself would cut it, so that a cell stays
    where it is. Every robot becomes a position model with one ranger, in id order: stage_ros calls them robot_0, ...

    Args:   bitmap: the name of the PNG, relative to the world file. resolution_m: edge of a pixel.
    Raises: ScenarioError: the plan has no solid, or a robot is a car. PlacementError: a robot stands badly.
    """
    robots = scenario.placed_robots()
    if any(robot.drive.kind == "car" for robot in robots):
        text = "robots.drive.kind: a car of Stage takes a steering angle for a turn: wanted another drive"
        raise ScenarioError(f"{scenario.name}: {text}")
    pixels = math.prod(grid_shape(scenario.plan, resolution_m))
    if pixels > MAX_PIXELS:
        raise ScenarioError(
            f"{scenario.name}: plan: at {resolution_m:g} m a pixel has {pixels} pixels; up to {MAX_PIXELS}"
        )
    grid = occupancy_grid(scenario.plan, resolution_m)
    solid = grid.cells == OCCUPIED
    if not solid.any():
        raise ScenarioError(f"{scenario.name}: plan: has no wall, block or closed door to draw a bitmap of")
    rows, columns = np.flatnonzero(solid.any(axis=1)), np.flatnonzero(solid.any(axis=0))
    low, high = (int(columns[0]), int(rows[0])), (int(columns[-1]) + 1, int(rows[-1]) + 1)
    grey = np.where(solid[low[1] : high[1], low[0] : high[0]], 0, 255).astype(np.uint8)
    size = [(b - a) * resolution_m for a, b in zip(low, high, strict=True)]
    middle = [o + 0.5 * (a + b) * resolution_m for o, a, b in zip(grid.origin_m, low, high, strict=True)]
    kinds = list(dict.fromkeys(_kind(robot) for robot in robots))
    lowest_m = min(robot.height_m for robot in robots)
    lines = [
        f"# {scenario.name}: made by `robotteamsim plan export-stage`",
        f'name "{_text(scenario.name)}"',
        f"interval_sim {_number(scenario.run.step_s * 1000.0)}  # a step [ms]: commands, scans and odometry",
        f"quit_time {_number(scenario.mission.time_limit_s)}  # [s]",
        f"resolution {_number(_RAYTRACE_M)}  # of Stage's rays and collisions [m]",
        *_floor_plan(scenario, bitmap, size, middle),
    ]
    for number, kind in enumerate(kinds):
        lines += _defined(f"robot_kind_{number}", kind, lowest_m, scenario.run.step_ns)
    lines.append("")
    for i, robot in enumerate(robots):
        x, y, yaw = robot.start_pose
        name = f"robot_kind_{kinds.index(_kind(robot))}"
        color = _COLORS[i % len(_COLORS)]
        lines.append(f'{name}( pose {_tuple(x, y, 0.0, math.degrees(yaw))} name "robot_{i}" color "{color}" )')
    image = cv2.imencode(".png", np.flipud(grey))[1].tobytes()
    return StageExport("\n".join(lines) + "\n", image, _notes(scenario, robots))


def _notes(scenario: Scenario, robots: Sequence[PlacedRobot]) -> tuple[str, ...]:
    notes = []
    if any(robot.odometry != _EXACT for robot in robots):
        notes.append("odometry drifts by the alphas here, and by a fixed share of every motion in Stage: odom_error")
    if scenario.plan.doors:
        notes.append("doors stay as they are at the start: Stage has none that move, so closed ones are walls")
    if any(robot.footprint_m for robot in robots):
        notes.append("footprint_m: a robot with corners becomes the disc around base_link that holds it")
    if any(robot.laser.no_return == "inf" for robot in robots):
        notes.append("laser.no_return: Stage says range_max where nothing is hit, never inf")
    if any(robot.mounts or robot.gps for robot in robots):
        notes.append("lasers, sonars, gps: only the first laser of a robot is written")
    if len(robots) == 1:
        notes.append("stage_ros leaves out robot_0/ in the names of topics where there is one robot")
    return tuple(notes)


_EXACT = Odometry(alpha1=0.0, alpha2=0.0, alpha3=0.0, alpha4=0.0)


def _kind(robot: PlacedRobot) -> PlacedRobot:
    """Return a robot as all of its kind are."""
    return robot.model_copy(update={"start_pose": (0.0, 0.0, 0.0)})


def _floor_plan(scenario: Scenario, bitmap: str, size: Sequence[float], middle: Sequence[float]) -> list[str]:
    elements: tuple[Wall | Block | Door, ...] = (*scenario.plan.walls, *scenario.plan.blocks, *scenario.plan.doors)
    height_m = max(element.height_m for element in elements)
    return [
        "",
        "model",
        "(",
        '  name "floorplan"',
        f'  bitmap "{_text(bitmap)}"',
        f"  size {_tuple(*size, height_m)}",
        f"  pose {_tuple(*middle, 0.0, 0.0)}",
        '  color "gray30"',
        "  gui_move 0",
        "  gui_outline 0",
        "  gripper_return 0",
        "  fiducial_return 0",
        ")",
    ]


def _defined(name: str, robot: PlacedRobot, lowest_m: float, step_ns: int) -> list[str]:
    """Return the definition of a kind of robot.

    Args: lowest_m: height of the lowest robot; rays pass below it, so that robots see each other as they do here.
    """
    # Stage takes whole milliseconds.
    update = f"  update_interval {max(step_ns // 1_000_000, 1)}"
    diameter = 2.0 * robot.reach_m
    angles = [2.0 * math.pi * i / _DISC_CORNERS for i in range(_DISC_CORNERS)]
    points = [(robot.reach_m * math.cos(angle), robot.reach_m * math.sin(angle)) for angle in angles]
    return [
        "",
        f"define {name} position",
        "(",
        f"  size {_tuple(diameter, diameter, robot.height_m)}",
        "  # a disc",
        f"  block( points {_DISC_CORNERS}",
        *(f"    point[{i}] {_tuple(x, y)}" for i, (x, y) in enumerate(points)),
        "    z [ 0 1 ]",
        "  )",
        "  gui_nose 1",
        update,
        f"  mass {_number(robot.mass_kg)}",
        *_drive(robot.drive),
        *_odometry(robot.odometry),
        *_ranger(robot.laser, robot.height_m, lowest_m, update),
        ")",
    ]


def _drive(drive: AnyDrive) -> list[str]:
    assert drive.kind != "car"
    aside = drive.max_speed_mps if drive.kind == "omni" else 0.0
    aside_change = drive.max_acceleration_mps2 if drive.kind == "omni" else 0.0
    speed, turn = drive.max_speed_mps, math.degrees(drive.max_turn_radps)
    change, turn_change = drive.max_acceleration_mps2, math.degrees(drive.max_turn_acceleration_radps2)
    return [
        f'  drive "{"omni" if drive.kind == "omni" else "diff"}"',
        f"  velocity_bounds {_tuple(-speed, speed, -aside, aside, 0.0, 0.0, -turn, turn)}",
        f"  acceleration_bounds "
        f"{_tuple(-change, change, -aside_change, aside_change, 0.0, 0.0, -turn_change, turn_change)}",
    ]


def _odometry(odometry: Odometry) -> list[str]:
    if odometry == _EXACT:
        return ['  localization "gps"']
    # What comes back from `import-stage` is alpha1 and alpha3.
    share, turn_share = math.sqrt(odometry.alpha3), math.degrees(math.sqrt(odometry.alpha1))
    return ['  localization "odom"', f"  odom_error {_tuple(share, share, 0.0, turn_share)}"]


def _ranger(laser: Laser, height_m: float, lowest_m: float, update: str) -> list[str]:
    middle = 0.5 * (laser.angle_min_rad + laser.angle_max_rad)
    fov = laser.angle_max_rad - laser.angle_min_rad
    # stage_ros takes tf from the ranger's pose, rays start at the sensor's: one may stand right, the other see robots.
    ray_m = laser.height_m if laser.height_m < 0.9 * lowest_m else 0.5 * lowest_m
    noise = [f"      noise {_tuple(laser.noise_m**2, 0.0, 0.0)}  # a variance [m^2]"] if laser.noise_m else []
    return [
        "  ranger",
        "  (",
        f"    pose {_tuple(laser.forward_m, 0.0, laser.height_m - height_m, math.degrees(middle))}",
        f"  {update}",
        "    sensor",
        "    (",
        f"      pose {_tuple(0.0, 0.0, ray_m - laser.height_m, 0.0)}",
        "      size [ 0.02 0.02 0 ]",
        f"      range {_tuple(laser.range_min_m, laser.range_max_m)}",
        f"      fov {_number(math.degrees(fov))}",
        f"      samples {laser.beams}",
        *noise,
        "    )",
        "  )",
    ]


def _tuple(*values: float) -> str:
    return f"[ {' '.join(map(_number, values))} ]"


def _number(value: float) -> str:
    """Return a number as Stage reads it: digits, a point and a sign, no exponent."""
    text = f"{value:.12f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def _text(text: str) -> str:
    """Return a text without what would end it in a world file."""
    return text.replace('"', "'").replace("\n", " ")
