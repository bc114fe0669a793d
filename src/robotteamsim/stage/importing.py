"""Imports a Stage world file as a scenario and its floor plan."""

import itertools
import math
import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from pydantic import ValidationError

from robotteamsim.errors import PlacementError, ScenarioError
from robotteamsim.formats import Imported
from robotteamsim.scenario.building import building_of
from robotteamsim.scenario.door_places import misplaced_doors
from robotteamsim.scenario.floor_plan import Block, FloorPlan
from robotteamsim.scenario.plan import door_corners, wall_corners
from robotteamsim.scenario.problems import problems, suggestion
from robotteamsim.scenario.scenario import MAX_ROBOTS, Scenario
from robotteamsim.scenario.sections import Mission, PlacedRobot, Run, Team
from robotteamsim.stage.rangers import RANGERS
from robotteamsim.stage.robots import DEVICES, RobotReader
from robotteamsim.stage.solids import BODIES, SolidReader
from robotteamsim.stage.values import Notes, Pose2, Values, compose, tidy
from robotteamsim.stage.world_file import Entity, read_world_file
from robotteamsim.wording import printable
from robotteamsim.world.placement import placed_robots

_WITHOUT_EFFECT = """
    alwayson blob_return color color_rgba confirm_on_quit debug event_queue fiducial_key fiducial_return friction
    give_watts gripper_return gui_boundary gui_disable gui_grid gui_interval gui_move gui_movemask gui_nose gui_outline
    interval_real joules joules_capacity kjoules kjoules_capacity laser_return map_resolution mass obstacle_return
    paused ranger_return resolution say show_clock show_clock_interval speedup stack_children take_watts threads
    trail_interval trail_length update_interval velocity watts wheelbase"""
"""Keys of Stage without effect here: appearance, other sensors, Stage's own timing."""

_SILENT = re.compile(r"name|size|origin|z|boundary|noblocks|pose|point\[\d+\]")
"""If these are not read, they only describe the appearance of a ranger or the name of a robot."""

DEFAULT_STEP_MS = 100.0
"""Default of `interval_sim` (Stage 4)."""

OUTSIDE_M = 5.0
"""Floor of the plan around a robot that starts outside the walls."""

_PARENTS = {
    "block": ("model", "actuator", "gripper", "position", "ranger", "laser"),
    "sensor": ("ranger",),
}
_MODELS = (*BODIES, *RANGERS, "position", *DEVICES, *_PARENTS, "window")


def import_world(world: str | os.PathLike[str], *, grey_as_stage: bool = False) -> Imported:
    """Return the scenario of a Stage world file, interpreted as by Stage 4 and stage_ros.

    Args:   grey_as_stage: whether a pixel of a bitmap is solid if its first channel is below 128, as in Stage, and not
                by the rule of every import.
    Raises: ScenarioError: one line with file, line, key and what was expected; the exception's notes contain all
            further refusals. PlacementError: likewise, robots are in walls or in other robots.
    """
    path, notes = Path(world), Notes()
    root = read_world_file(path, os.fspath(world))
    values = Values(root, notes)
    _check_kinds(root, notes, on_robot=False)
    positions = list(_positions(root, values, (0.0, 0.0, 0.0)))
    if len(positions) > MAX_ROBOTS:
        raise ScenarioError(f"{path}: {len(positions)} robots (models of kind position); expected at most {MAX_ROBOTS}")
    keys: dict[str, Any] = {"name": printable(values.text(root, "name", path.stem))[:100] or path.stem}
    step_s = tidy(values.number(root, "interval_sim", "f", DEFAULT_STEP_MS) / 1000.0)
    run = notes.checked(Run, {"step_s": step_s}, {"step_s": (root, "interval_sim")})
    if root.get("interval_sim"):
        keys["run"] = run.model_dump(include={"step_s"})
    if (limit_s := values.number(root, "quit_time", "f", 0.0)) > 0.0:
        mission = notes.checked(Mission, {"time_limit_s": limit_s}, {"time_limit_s": (root, "quit_time")})
        keys["mission"] = mission.model_dump(include={"time_limit_s"})
    reader, robots, placed = RobotReader(values, 1000.0 * run.step_s), [], []
    for number, (entity, parent) in enumerate(positions, 1):
        with notes.refusals():
            robots.append(reader.read(entity, parent, number))
            placed.append(entity)
    starts = [robot.start_pose[:2] for robot in robots]
    solids = SolidReader(path.parent, values, starts, grey_as_stage=grey_as_stage)
    plan = _plan(root, path, robots, solids)
    notes.raise_refusals()
    _note_unread(root, values)
    if not robots:
        notes.say(root.place, "no robot (a model of kind position): only the floor plan is imported")
        return Imported(plan, tuple(notes.lines()))
    keys["robots"] = _team_or_list(robots)
    scenario = notes.checked(Scenario, {**keys, "plan": plan}, {"name": (root, "name")})
    _check_poses(scenario, robots, placed, notes)
    return Imported(plan, tuple(notes.lines()), keys, scenario)


def _check_kinds(parent: Entity, notes: Notes, *, on_robot: bool) -> None:
    """Refuse unknown models, and parts where Stage does not load them either; note those that are omitted."""
    for child in parent.children:
        if child.kind not in _MODELS:
            near = suggestion(child.kind, _MODELS)
            notes.refuse(child.place.error(f"{child.called}: unknown model '{child.kind}'{near}"))
        elif child.kind in _PARENTS and parent.kind not in _PARENTS[child.kind]:
            notes.refuse(
                child.place.error(f"{child.called}: a '{child.kind}' that is not in a {_PARENTS[child.kind][0]}")
            )
        elif child.kind == "window":
            notes.without_effect("window", child.place)
        elif child.kind in (*RANGERS, *DEVICES) and not on_robot:
            notes.say(child.place, f"{child.called}: omitted: a '{child.kind}' that is not on a robot")
        _check_kinds(child, notes, on_robot=on_robot or child.kind == "position")


def _positions(parent: Entity, values: Values, frame: Pose2) -> Iterator[tuple[Entity, Pose2]]:
    """Yield the robots, also those on models, with the frame that their poses are given in."""
    for child in parent.children:
        if child.kind == "position":
            yield child, frame
        elif child.kind in BODIES:
            with values.notes.refusals():
                yield from list(_positions(child, values, compose(frame, values.pose(child, "pose")[0])))


def _plan(root: Entity, path: Path, robots: list[PlacedRobot], reader: SolidReader) -> FloorPlan:
    """Return the floor plan: the bodies of all models, and a rectangle that contains them and all robots.

    Raises: ScenarioError: it is too large, or there is nothing.
    """
    models, notes = root.of_kind(*BODIES), reader.notes
    for model in models:
        with notes.refusals():
            reader.add(model, (0.0, 0.0, 0.0), 0.0, max((robot.height_m for robot in robots), default=math.inf))
    corners = [*itertools.chain.from_iterable(reader.floor.values())]
    corners += [corner for block in reader.blocks for corner in block.polygon]
    for wall in reader.walls:
        corners += [wall.start, wall.end] if reader.floor else wall_corners(wall)
    for door in reader.doors:
        corners += [door.start, door.end]
    inside = shapely.MultiPoint(corners).envelope
    for robot in robots:
        x_m, y_m, _ = robot.start_pose
        if not inside.covers(shapely.Point(x_m, y_m)):
            reach_m = robot.reach_m + OUTSIDE_M
            corners += [(x_m - reach_m, y_m - reach_m), (x_m + reach_m, y_m + reach_m)]
    notes.raise_refusals()
    if not corners:
        raise ScenarioError(f"{path}: nothing to import: no robot, and no model with a bitmap, blocks or boundary 1")
    solids = {"walls": reader.walls, "blocks": reader.blocks, "doors": reader.doors}
    low, high = (np.round(edge, 6).tolist() for edge in (np.min(corners, axis=0), np.max(corners, axis=0)))
    keys = {"name": next(iter(reader.floor), path.stem), "bounds": {"min": low, "max": high}, **solids}
    try:
        plan = FloorPlan.model_validate(keys)
    except ValidationError as error:
        place = models[0].place if models else root.place
        raise place.error(f"{(models or [root])[0].called}: {problems(error, FloorPlan)[0]}") from None
    left_out = {index for index, _ in misplaced_doors(plan)}
    shut = [plan.doors[index] for index in sorted(left_out) if plan.doors[index].closed]
    shut_blocks = [Block(name=door.name, polygon=door_corners(door), height_m=door.height_m) for door in shut]
    doors = tuple(door for index, door in enumerate(plan.doors) if index not in left_out)
    return plan.model_copy(update={"blocks": (*plan.blocks, *shut_blocks), "doors": doors})


def _check_poses(scenario: Scenario, robots: list[PlacedRobot], positions: list[Entity], notes: Notes) -> None:
    """Raise PlacementError, with its line of the world file, for the robots that do not fit where they start."""
    left, building = list(zip(robots, positions, strict=True)), building_of(scenario.plan)
    while left:
        try:
            placed_robots(scenario.model_copy(update={"robots": tuple(robot for robot, _ in left)}), building)
            break
        except PlacementError as error:
            # Of a list of robots, the key is robots.<index>.start_pose.
            text = str(error).removeprefix(f"{error.key}: ")
            _, entity = left.pop(int(error.key.split(".")[1]))
            notes.refuse(PlacementError(f"{entity.place_of('pose')}: pose: {text}"))
    notes.raise_refusals()


def _team_or_list(robots: list[PlacedRobot]) -> Any:
    """Return the robots as in YAML: a team if all are equal except for their poses, else a list."""
    data = [robot.model_dump(mode="json", exclude_unset=True) for robot in robots]
    poses = [robot.pop("start_pose") for robot in data]
    if any(robot != data[0] for robot in data):
        return [{"start_pose": pose, **robot} for pose, robot in zip(poses, data, strict=True)]
    widest_m = 2.0 * robots[0].reach_m
    spacing = {"spacing_m": widest_m} if widest_m > Team.model_fields["spacing_m"].default else {}
    return {"count": len(robots), "start_poses": poses, **spacing, **data[0]}


def _note_unread(root: Entity, values: Values) -> None:
    """Note every property that was not read, except those of models that are omitted."""
    without_effect, notes = _WITHOUT_EFFECT.split(), values.notes
    for entity in _taken(root):
        for given in entity.properties.values():
            name = given.name
            if values.was_read(given) or _SILENT.fullmatch(name) or entity.kind in ("actuator", "gripper"):
                continue
            if name in without_effect:
                notes.without_effect(name, given.place)
            elif name == "ctrl":
                notes.say(given.place, "ctrl: omitted: Stage's controllers cannot run here; control.algorithm drives")
            else:
                near = suggestion(name, [*without_effect, *sorted(values.names)])
                notes.say(given.place, f"{name}: unknown key of a '{entity.kind}', in Stage and here{near}")


def _taken(entity: Entity, on_robot: bool = False) -> Iterator[Entity]:
    """Yield the entities that become part of the scenario."""
    yield entity
    for child in entity.children:
        is_sensor = child.kind in RANGERS and on_robot and (child.kind == "laser" or child.of_kind("sensor"))
        if child.kind in (*BODIES, "position", "block", "sensor") or is_sensor:
            yield from _taken(child, on_robot or child.kind == "position")
