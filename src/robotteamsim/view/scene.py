"""What a viewer draws and what stays the same during a mission: building, areas, robots, objects, colours."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import msgspec
import numpy as np

from robotteamsim import palette
from robotteamsim.recording.replay.recorded_run import RecordedRun
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.plan import (
    OCCUPIED,
    Corners,
    OccupancyGrid,
    bay_lines,
    door_corners,
    floors,
    level_marks,
    solids,
)
from robotteamsim.scenario.scenario import Role, Scenario
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.setup import Setup

_GRID_WALL_HEIGHT_M = 1.0
"""Height of walls that are known only from an occupancy grid."""


class SolidShape(msgspec.Struct, frozen=True):
    """A wall, block or pillar: its outline [m], its height [m] and its colour."""

    outline: Corners
    height_m: float
    colour: str


class DoorShape(msgspec.Struct, frozen=True):
    """A door: the outline of its closed leaf [m], which turns about `hinge_m` or slides by `shift_m` as it opens."""

    name: str
    outline: Corners
    hinge_m: tuple[float, float]
    angle_rad: float
    shift_m: tuple[float, float]
    height_m: float
    colour: str
    is_instant: bool


class AreaShape(msgspec.Struct, frozen=True):
    """An area to explore, or an exit: a disc [m]."""

    name: str
    center_m: tuple[float, float]
    radius_m: float


class RobotShape(msgspec.Struct, frozen=True):
    """A robot: its outline in base_link [m], empty for a disc, and its laser.

    number: its id, or its place in a recorded run if the bag gives it no id.
    beams, angle_min_rad, angle_step_rad, forward_m, left_m, range_max_m: of the laser; no beams if it is unknown.
    role: a robot, or another member of the team.
    """

    name: str
    colour: str
    radius_m: float
    outline: Corners
    height_m: float
    beams: int = 0
    angle_min_rad: float = 0.0
    angle_step_rad: float = 0.0
    forward_m: float = 0.0
    left_m: float = 0.0
    range_max_m: float = 0.0
    role: Role = "robot"
    number: int = 0


class ObjectShape(msgspec.Struct, frozen=True):
    """A box or barrel: its outline around its centre [m], empty for a disc."""

    name: str
    radius_m: float
    outline: Corners
    height_m: float
    colour: str


class Scene(msgspec.Struct, frozen=True):
    """Everything that a viewer draws and that does not change during a mission; lengths in metres, frame `map`.

    bounds: x and y of the lower left and of the upper right corner.
    floors: bounds of the levels, or the whole floor.
    bays:   painted lines.
    levels: their names, and where they are written on the floor.
    stops:  of passages: discs.
    victim_states: that victims can have, for the legend.
    has_fire: whether there are maps of fire and smoke.
    has_beliefs: whether robots localise themselves.
    """

    title: str
    bounds: tuple[float, float, float, float]
    solids: tuple[SolidShape, ...]
    doors: tuple[DoorShape, ...]
    bays: tuple[tuple[tuple[float, float], tuple[float, float]], ...]
    areas: tuple[AreaShape, ...]
    robots: tuple[RobotShape, ...]
    objects: tuple[ObjectShape, ...]
    victim_states: tuple[str, ...] = ()
    has_fire: bool = False
    has_beliefs: bool = False
    exits: tuple[AreaShape, ...] = ()
    floors: tuple[tuple[float, float, float, float], ...] = ()
    levels: tuple[tuple[str, tuple[float, float]], ...] = ()
    stops: tuple[AreaShape, ...] = ()


def scene_of(setup: Setup) -> Scene:
    """Return the scene of a scenario."""
    scenario, plan = setup.scenario, setup.plan
    return Scene(
        title=scenario.name,
        bounds=(*plan.bounds.min, *plan.bounds.max),
        solids=_solids(plan),
        doors=_doors(plan),
        bays=bay_lines(plan),
        areas=tuple(AreaShape(area.name, area.center, area.radius_m) for area in scenario.mission.areas),
        robots=tuple(
            _robot(scenario.name_of(i).removeprefix("the ").replace(" ", "_"), i, robot, scenario.role_of(i))
            for i, robot in enumerate(setup.robots)
        ),
        objects=tuple(map(object_shape, scenario.objects)),
        victim_states=_victim_states(scenario),
        has_fire=scenario.fire is not None,
        has_beliefs=scenario.control.localises,
        exits=tuple(AreaShape(way.name, way.center, way.radius_m) for way in scenario.mission.exits),
        floors=tuple((*bounds.min, *bounds.max) for bounds in floors(plan)),
        levels=level_marks(plan),
        stops=tuple(AreaShape(one.name, stop, one.radius_m) for one in plan.passages for stop in one.stops),
    )


def _victim_states(scenario: Scenario) -> tuple[str, ...]:
    victims = scenario.mission.victims
    if not victims:
        return ()
    states = [*(palette.VICTIMS if scenario.mission.saved_by == "robot" else palette.RESCUED)]
    states += ["fleeing"] if any(victim.flees for victim in victims) else []
    states += ["collapsed", "dead"] if scenario.fire is not None else []
    return tuple(states)


def scene_of_run(run: RecordedRun, setup: Setup | None) -> Scene:
    """Return the scene of a recorded run: its areas and robots, in the building of a scenario or of the bag's map."""
    if setup is not None:
        known = scene_of(setup)
        bounds, walls, doors, bays = known.bounds, known.solids, known.doors, known.bays
    else:
        bounds, walls, doors, bays = _bounds(run), _grid_solids(run.grid), (), ()
    shapes = {} if setup is None else dict(enumerate(known.robots))
    numbers = [index if robot.robot_id is None else robot.robot_id for index, robot in enumerate(run.robots)]
    robots = (
        msgspec.structs.replace(
            shapes.get(number, _UNKNOWN_ROBOT), name=robot.name, colour=palette.robot_colour(number), number=number
        )
        for number, robot in zip(numbers, run.robots, strict=True)
    )
    return Scene(
        title=run.name,
        bounds=bounds,
        solids=walls,
        doors=doors,
        bays=bays,
        areas=tuple(AreaShape(area.name, area.center_m, area.radius_m) for area in run.areas),
        robots=tuple(robots),
        objects=(),
        victim_states=_states_of_run(run) if setup is None else known.victim_states,
        exits=() if setup is None else known.exits,
        floors=() if setup is None else known.floors,
        levels=() if setup is None else known.levels,
        stops=() if setup is None else known.stops,
    )


def _states_of_run(run: RecordedRun) -> tuple[str, ...]:
    """Return the states that victims of a run have had, in the order of the palette."""
    seen = {victim.state for _, victims in run.victims for victim in victims}
    return tuple(state for state in palette.VICTIM_STATES if state in seen)


_UNKNOWN_ROBOT = RobotShape("", "", 0.2, (), 0.25)


def _solids(plan: FloorPlan) -> tuple[SolidShape, ...]:
    fixed = (solid for solid in solids(plan) if solid.kind != "door")
    return tuple(SolidShape(solid.corners, solid.element.height_m, palette.LIT_SOLIDS[solid.kind]) for solid in fixed)


def _doors(plan: FloorPlan) -> tuple[DoorShape, ...]:
    return tuple(
        DoorShape(
            name=door.name,
            outline=door_corners(door),
            hinge_m=door.start,
            angle_rad=door.leaf_angle_rad,
            shift_m=door.leaf_shift_m,
            height_m=door.height_m,
            colour=palette.LIT_DOORS[door.kind],
            is_instant=door.motion == "instant",
        )
        for door in plan.doors
    )


def object_shape(obj: MovableObject) -> ObjectShape:
    """Return the shape of an object."""
    colour = palette.BOX if obj.kind == "box" else palette.BARREL
    return ObjectShape(obj.name, obj.reach_m, obj.corners_m, obj.height_m, colour)


def _robot(name: str, index: int, robot: PlacedRobot, role: Role) -> RobotShape:
    laser = robot.laser
    return RobotShape(
        name=name,
        colour=palette.robot_colour(index),
        radius_m=robot.reach_m,
        outline=robot.corners_m,
        height_m=robot.height_m,
        beams=laser.beams,
        angle_min_rad=laser.angle_min_rad,
        angle_step_rad=(laser.angle_max_rad - laser.angle_min_rad) / max(laser.beams - 1, 1),
        forward_m=laser.forward_m,
        left_m=laser.left_m,
        range_max_m=laser.range_max_m,
        role=role,
        number=index,
    )


def _bounds(run: RecordedRun) -> tuple[float, float, float, float]:
    """Return the rectangle around the known part of the bag's map, all paths and areas [m]."""
    points = [robot.track.poses[:, :2] for robot in run.robots]
    points += [np.add(area.center_m, [[-area.radius_m] * 2, [area.radius_m] * 2]) for area in run.areas]
    if run.grid is not None:
        rows, columns = np.nonzero(run.grid.cells == OCCUPIED)
        cells = np.column_stack((columns, rows))
        points += [run.grid.origin_m + run.grid.resolution_m * (cells + corner) for corner in (0, 1)]
    everything = np.concatenate([*points, np.zeros((0, 2))])
    if not len(everything):
        return (0.0, 0.0, 1.0, 1.0)
    (x0, y0), (x1, y1) = everything.min(axis=0).tolist(), everything.max(axis=0).tolist()
    return x0 - 1.0, y0 - 1.0, x1 + 1.0, y1 + 1.0


def _grid_solids(grid: OccupancyGrid | None) -> tuple[SolidShape, ...]:
    if grid is None:
        return ()
    (x0, y0), size_m = grid.origin_m, grid.resolution_m
    return tuple(
        SolidShape(
            (
                (x0 + left * size_m, y0 + bottom * size_m),
                (x0 + right * size_m, y0 + bottom * size_m),
                (x0 + right * size_m, y0 + top * size_m),
                (x0 + left * size_m, y0 + top * size_m),
            ),
            _GRID_WALL_HEIGHT_M,
            palette.LIT_SOLIDS["wall"],
        )
        for left, right, bottom, top in rectangles(grid.cells == OCCUPIED)
    )


def rectangles(occupied: np.ndarray) -> Iterator[tuple[int, int, int, int]]:
    """Yield rectangles (left, right, bottom, top) that together cover the occupied cells, each cell once.

    Equal runs of cells in successive rows become one rectangle. Args: occupied: bool, shape (rows, columns).
    """
    begun: dict[tuple[int, int], int] = {}
    for row, cells in enumerate([*occupied, np.zeros(occupied.shape[1], dtype=bool)]):
        runs = set(_runs(cells))
        for left, right in sorted(begun.keys() - runs):
            yield left, right, begun.pop((left, right)), row
        for run in sorted(runs - begun.keys()):
            begun[run] = row


def _runs(cells: np.ndarray) -> Sequence[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate(([0], cells.astype(np.int8), [0])))).tolist()
    return list(zip(edges[::2], edges[1::2], strict=True))
