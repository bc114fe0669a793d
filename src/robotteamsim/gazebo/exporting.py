"""Exports a scenario as a world of Gazebo: one file in SDF, with all models in it."""

import math
from collections.abc import Sequence

from robotteamsim import palette
from robotteamsim.formats import Exported
from robotteamsim.gazebo.doors import BUILDING_BITS, door_model, door_setting
from robotteamsim.gazebo.elements import (
    Element,
    element,
    flag,
    material,
    model,
    pose,
    static_model,
    surface,
    text_of,
    values,
)
from robotteamsim.gazebo.names import BLOCKS, DOOR, FLOOR, OBJECT, PILLARS, ROBOT, WALLS, WORLD_PLUGIN, Names
from robotteamsim.gazebo.robots import DriveKind, has_wheels, robot_model
from robotteamsim.gazebo.shapes import Solid
from robotteamsim.scenario.floor_plan import Block, Bounds, FloorPlan, Wall
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.plan import Corners, counter_clockwise
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.setup import Setup
from robotteamsim.wording import counted

VERSION = "1.6"
"""Of SDF; Gazebo 9 to 11 read it."""

_LONGEST_STEP_S = 0.005
"""Of Gazebo's physics; a step of the scenario consists of several."""

_FLOOR_FRICTION = 100.0
"""As of Gazebo's own floor: that of the bodies on it acts."""


def export_world(setup: Setup, drive: DriveKind = "velocity") -> Exported:
    """Return a scenario as a world of Gazebo 11, with the plugins of this package, and files of the absent robots.

    The floor, the walls, blocks and pillars are four static models. Doors, objects and robots are a model each:
    door_<name>, object_<name> and robot_<id>.

    Args: drive: how robots with a differential drive move.
    """
    scenario, robots = setup.scenario, setup.robots
    models = {
        f"{ROBOT}{i}": robot_model(f"{ROBOT}{i}", robot, drive, scenario.run.step_s, palette.robot_colour(i))
        for i, robot in enumerate(robots)
    }
    present = [name for name, robot in zip(models, robots, strict=True) if robot.present]
    names = Names()
    plan, doors = scenario.plan, {names.unused(f"{DOOR}{door.name}"): door for door in scenario.plan.doors}
    settings = [values("step_s", scenario.run.step_s), *(door_setting(name, door) for name, door in doors.items())]
    world = element(
        "world",
        _physics(scenario.run.step_s),
        *_light_and_camera(plan.bounds),
        _floor(plan.bounds),
        *_building(plan),
        *(door_model(name, door) for name, door in doors.items()),
        *(_object(names.unused(f"{OBJECT}{obj.name}"), obj) for obj in scenario.objects),
        *(models[name] for name in present),
        element("plugin", *settings, name="robotteamsim_world", filename=WORLD_PLUGIN),
        name=Names().unused(scenario.name),
    )
    absent = {f"{name}.sdf": _file(models[name]) for name in models if name not in present}
    summary = f"{counted(scenario.num_robots - len(absent), 'robot')}, {counted(len(doors), 'door')}"
    return Exported(_file(world), summary, _notes(scenario, robots, drive), absent)


def _file(content: Element) -> str:
    return text_of(element("sdf", content, version=VERSION))


def _notes(scenario: Scenario, robots: Sequence[PlacedRobot], drive: DriveKind) -> tuple[str, ...]:
    notes = []
    if drive == "wheels" and not all(has_wheels(robot, drive) for robot in robots):
        notes.append("robots.drive: only differential drives have wheels in Gazebo; the others move by their velocity")
    for key in ("gripper", "sensors"):
        if any(getattr(robot, key) for robot in robots):
            notes.append(f"robots.{key}: omitted: in Gazebo, robots have only a body and one laser")
    mujoco = scenario.run.mujoco
    for key, is_used in (("lights", mujoco.lights), ("ramps", mujoco.ramps)):
        if is_used:
            notes.append(f"run.mujoco.{key}: omitted: only in the world of MuJoCo")
    if any(not robot.present for robot in robots):
        notes.append("robots: those that arrive later have a file each, for `rosrun gazebo_ros spawn_model -sdf`")
    return tuple(notes)


def _physics(step_s: float) -> Element:
    part_s = step_s / math.ceil(step_s / _LONGEST_STEP_S - 1e-9)
    return element(
        "physics",
        values("max_step_size", part_s),
        values("real_time_factor", 1.0),
        values("real_time_update_rate", 1.0 / part_s),
        name="default_physics",
        type="ode",
    )


def _light_and_camera(bounds: Bounds) -> tuple[Element, ...]:
    (min_x, min_y), (max_x, max_y) = bounds.min, bounds.max
    side_m = max(max_x - min_x, max_y - min_y)
    sun = element(
        "light",
        pose(0.0, 0.0, 10.0),
        flag("cast_shadows", True),
        values("diffuse", 0.6, 0.6, 0.58, 1.0),
        values("specular", 0.05, 0.05, 0.05, 1.0),
        values("direction", -0.4, 0.3, -0.9),
        name="sun",
        type="directional",
    )
    ambient = element("scene", values("ambient", 0.4, 0.4, 0.42, 1.0), values("background", 0.8, 0.85, 0.9, 1.0))
    # From the south, looking down steeply.
    eye = values("pose", 0.5 * (min_x + max_x), min_y - 0.2 * side_m, 0.9 * side_m, 0.0, 1.05, 0.5 * math.pi)
    gui = element("gui", element("camera", eye, name="user_camera"))
    return ambient, sun, gui


def _floor(bounds: Bounds) -> Element:
    (min_x, min_y), (max_x, max_y) = bounds.min, bounds.max
    size = values("size", max_x - min_x, max_y - min_y)
    geometry = element("geometry", element("plane", values("normal", 0.0, 0.0, 1.0), size))
    touch = surface(mu=_FLOOR_FRICTION, collide_bits=BUILDING_BITS)
    link = element(
        "link",
        element("collision", geometry, touch, name="collision"),
        element("visual", geometry, material(palette.BAY), name="visual"),
        name="link",
    )
    return static_model(FLOOR, pose(0.5 * (min_x + max_x), 0.5 * (min_y + max_y)), link)


def _building(plan: FloorPlan) -> list[Element]:
    """Return the models of walls, blocks and pillars, as far as the plan has any."""
    kinds: dict[str, tuple[str, Sequence[Wall | Block]]] = {
        WALLS: ("wall", plan.walls),
        BLOCKS: ("block", [block for block in plan.blocks if block.kind == "block"]),
        PILLARS: ("pillar", [block for block in plan.blocks if block.kind == "pillar"]),
    }
    made = []
    for name, (kind, elements) in kinds.items():
        names = Names()
        links = [_fixed(names.unused(one.name), one, palette.LIT_SOLIDS[kind]) for one in elements]
        made += [static_model(name, *links)] if links else []
    return made


def _fixed(name: str, part: Wall | Block, colour: str) -> Element:
    """Return the link of a wall or block; the x axis of a wall's link is along the wall."""
    if isinstance(part, Wall):
        (x, y), (end_x, end_y), half_m = part.start, part.end, 0.5 * part.thickness_m
        length_m = math.dist(part.start, part.end)
        corners: Corners = ((0.0, -half_m), (length_m, -half_m), (length_m, half_m), (0.0, half_m))
        place = pose(x, y, 0.0, math.atan2(end_y - y, end_x - x))
    else:
        # Around its first corner, so that points far from the origin keep their precision.
        (x, y), place = part.polygon[0], pose(*part.polygon[0])
        corners = tuple((px - x, py - y) for px, py in counter_clockwise(part.polygon))
    solid = Solid(0.0, part.height_m, corners)
    collision = solid.collision("collision", surface(collide_bits=BUILDING_BITS))
    return element("link", place, collision, solid.visual("visual", colour), name=name)


def _object(name: str, obj: MovableObject) -> Element:
    solid = Solid(0.0, obj.height_m, obj.corners_m, obj.radius_m or 0.0)
    link = element(
        "link",
        solid.inertial(obj.mass_kg),
        solid.collision("collision", surface(mu=obj.friction)),
        solid.visual("visual", palette.BOX if obj.kind == "box" else palette.BARREL),
        name="link",
    )
    x, y, yaw = obj.pose
    return model(name, pose(x, y, 0.0, yaw), link)
