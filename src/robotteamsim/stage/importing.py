"""Imports a Stage world file as a scenario and its floor plan."""

import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from robotteamsim.errors import PlacementError, ScenarioError
from robotteamsim.scenario.building import building_of
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.plan import wall_corners
from robotteamsim.scenario.problems import problems, suggestion
from robotteamsim.scenario.scenario import MAX_ROBOTS, Scenario
from robotteamsim.scenario.sections import Mission, PlacedRobot, Run, Team
from robotteamsim.stage.robots import DEVICES, RobotReader
from robotteamsim.stage.solids import SolidReader
from robotteamsim.stage.values import Notes, Values, checked, tidy
from robotteamsim.stage.world_file import Entity, read_world_file
from robotteamsim.world.placement import placed_robots

_WITHOUT_EFFECT = """
    alwayson blob_return color color_rgba confirm_on_quit debug event_queue fiducial_key fiducial_return friction
    give_watts gripper_return gui_boundary gui_disable gui_grid gui_interval gui_move gui_movemask gui_nose gui_outline
    interval_real joules joules_capacity kjoules kjoules_capacity laser_return map_resolution mass obstacle_return
    paused ranger_return resolution say show_clock show_clock_interval speedup stack_children take_watts threads
    trail_interval trail_length update_interval velocity watts wheelbase"""
"""Keys of Stage without effect here: appearance, other sensors, Stage's own timing."""

_TAKEN = """
    acceleration_bounds bitmap boundary drive fov interval_sim localization localization_origin name noblocks noise
    odom_error origin points pose quit_time range range_max range_min samples size unit_angle unit_length
    velocity_bounds z"""
_SILENT = re.compile(r"name|size|origin|z|point\[\d+\]")
"""If these are not read, they only describe the appearance of a ranger or the name of a robot."""

DEFAULT_STEP_MS = 100.0
"""Default of `interval_sim` (Stage 4)."""

_NO_SECTION = ("block", "sensor", "window", "gripper", "actuator", "puck", "charger")
_MODELS = ("model", "position", "ranger", "laser", *DEVICES, *_NO_SECTION)


@dataclass(frozen=True, slots=True)
class StageImport:
    """The contents of a world file.

    plan:     the floor plan.
    keys:     the scenario's keys as in YAML, without `plan`.
    scenario: the same, checked.
    notes:    one line each: what is interpreted differently, and per file what has no effect.
    """

    plan: FloorPlan
    keys: dict[str, Any]
    scenario: Scenario
    notes: tuple[str, ...]


def import_world(world: str | os.PathLike[str]) -> StageImport:
    """Return the scenario of a Stage world file, interpreted as by Stage 4 and stage_ros.

    Raises: ScenarioError: one line with file, line, key and what was expected. PlacementError: likewise, a robot is
            outside the plan, in a wall or in another robot.
    """
    path = Path(world)
    root = read_world_file(path, os.fspath(world))
    values, notes = Values(root), Notes()
    _check_kinds(root, notes)
    positions = root.of_kind("position")
    if not 1 <= len(positions) <= MAX_ROBOTS:
        raise ScenarioError(f"{path}: {len(positions)} robots (models of kind position); expected 1 to {MAX_ROBOTS}")
    reader = RobotReader(values, notes, values.number(root, "interval_sim", "f", DEFAULT_STEP_MS))
    robots = tuple(reader.read(position) for position in positions)
    plan = _plan(root, path, max(robot.height_m for robot in robots), values, notes)
    keys: dict[str, Any] = {"name": values.text(root, "name", path.stem), "robots": _team_or_list(robots)}
    if root.get("interval_sim"):
        step = {"step_s": tidy(values.number(root, "interval_sim", "f", 0.0) / 1000.0)}
        keys["run"] = checked(Run, step, {"step_s": (root, "interval_sim")}).model_dump(include={"step_s"})
    if values.number(root, "quit_time", "f", 0.0) != 0.0:
        limit = {"time_limit_s": values.number(root, "quit_time", "f", 0.0)}
        checked(Mission, limit, {"time_limit_s": (root, "quit_time")})
        keys["mission"] = limit
    _note_unread(root, values, notes)
    scenario = checked(Scenario, {**keys, "plan": plan}, {"name": (root, "name")})
    _check_poses(scenario, robots, positions)
    return StageImport(plan, keys, scenario, tuple(notes.lines()))


def _check_kinds(root: Entity, notes: Notes) -> None:
    """Reject unknown models and those that would change the world, and note those that are omitted."""
    for entity in root.walk():
        if entity is not root and entity.kind not in _MODELS:
            near = suggestion(entity.kind, _MODELS)
            raise entity.place.error(f"{entity.called}: unknown model '{entity.kind}'{near}")
        if entity.kind not in ("world", "model"):
            continue
        allowed = ("position", "window") if entity is root else ("block",)
        for child in entity.children:
            if child.kind == "window" and entity is root:
                notes.without_effect("window", child.place)
            elif child.kind in ("ranger", "laser", *DEVICES):
                notes.say(child.place, f"{child.called}: omitted: a '{child.kind}' that is not on a robot")
            elif child.kind not in ("model", *allowed):
                on = "is not simulated" if entity is root else f"on the model '{entity.called}' is not simulated"
                raise child.place.error(f"{child.called}: a '{child.kind}' {on}")


def _plan(root: Entity, path: Path, tallest_m: float, values: Values, notes: Notes) -> FloorPlan:
    """Return the floor plan: the bodies of all models, and their bounding rectangle."""
    reader = SolidReader(path.parent, values, notes)
    models = root.of_kind("model")
    for model in models:
        reader.add(model, (0.0, 0.0, 0.0), 0.0, tallest_m)
    corners = [corner for wall in reader.walls for corner in wall_corners(wall)]
    corners += [corner for block in reader.blocks for corner in block.polygon]
    if not corners:
        raise ScenarioError(f"{path}: nothing bounds the world; expected a model with a bitmap, blocks or boundary 1")
    low, high = (np.round(edge, 6).tolist() for edge in (np.min(corners, axis=0), np.max(corners, axis=0)))
    keys = {"name": path.stem, "bounds": {"min": low, "max": high}, "walls": reader.walls, "blocks": reader.blocks}
    try:
        return FloorPlan.model_validate(keys)
    except ValidationError as error:
        raise models[0].place.error(f"{models[0].called}: {problems(error, FloorPlan)[0]}") from None


def _check_poses(scenario: Scenario, robots: tuple[PlacedRobot, ...], positions: list[Entity]) -> None:
    """Raise PlacementError, with its line of the world file, for a robot that does not fit where it starts."""
    try:
        placed_robots(scenario.model_copy(update={"robots": robots}), building_of(scenario.plan))
    except PlacementError as error:
        # Of a list of robots, the key is robots.<index>.start_pose.
        index = int(error.key.split(".")[1])
        text = str(error).removeprefix(f"{error.key}: ")
        raise PlacementError(f"{positions[index].place_of('pose')}: pose: {text}") from None


def _team_or_list(robots: tuple[PlacedRobot, ...]) -> Any:
    """Return the robots as in YAML: a team if all are equal except for their poses, else a list."""
    data = [robot.model_dump(mode="json", exclude_unset=True) for robot in robots]
    poses = [robot.pop("start_pose") for robot in data]
    if any(robot != data[0] for robot in data):
        return [{"start_pose": pose, **robot} for pose, robot in zip(poses, data, strict=True)]
    widest_m = 2.0 * robots[0].reach_m
    spacing = {"spacing_m": widest_m} if widest_m > Team.model_fields["spacing_m"].default else {}
    return {"count": len(robots), "start_poses": poses, **spacing, **data[0]}


def _note_unread(root: Entity, values: Values, notes: Notes) -> None:
    """Note every property that was not read. Raises: ScenarioError: one of them would change the world."""
    without_effect = _WITHOUT_EFFECT.split()
    for entity in _taken(root):
        for given in entity.properties.values():
            name = given.name
            if values.was_read(given) or _SILENT.fullmatch(name):
                continue
            if name in ("bitmap", "boundary"):
                raise given.place.error(f"{name}: only supported for models of kind 'model', not '{entity.kind}'")
            if name in without_effect:
                notes.without_effect(name, given.place)
            elif name == "ctrl":
                notes.say(given.place, "ctrl: omitted: Stage's controllers cannot run here; control.algorithm drives")
            else:
                near = suggestion(name, [*without_effect, *_TAKEN.split()])
                notes.say(given.place, f"{name}: unknown key of a '{entity.kind}', in Stage and here{near}")


def _taken(root: Entity) -> Iterator[Entity]:
    """Yield the entities that become part of the scenario."""
    yield root
    parts = {"position": ("ranger", "laser", "block"), "ranger": ("sensor",), "laser": (), "block": (), "sensor": ()}
    for child in root.children:
        if child.kind in parts.get(root.kind, ("model", "position", "block")):
            yield from _taken(child)
