"""Where robots stand at the start, and whether robots, areas and victims stand where they can."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence

import numpy as np
import shapely

from robotteamsim.errors import PlacementError
from robotteamsim.scenario.base import PlanarPose
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.plan import FREE, Solid, obstacles, occupancy_grid, solids
from robotteamsim.scenario.sections import Mission, PlacedRobot, Robot, Team

CLEARANCE_M = 0.05
"""Between a formation's robots and solids, beyond their radius."""

_REACH_RESOLUTION_M = 0.1
_MAX_REACH_CELLS = 2000
"""Along a side; the cells of larger plans are larger."""


# Trials that differ in their seed alone, and the parts of each, ask for the same formation: it takes 40 ms in a garage.
@functools.lru_cache(maxsize=16)
def placed_robots(plan: FloorPlan, robots: Team | tuple[PlacedRobot, ...]) -> tuple[PlacedRobot, ...]:
    """Return every robot with its start pose, in id order.

    A team takes its `start_poses` first; the others stand in a formation: a square grid of `spacing_m` in the frame
    of `start` (without one: the first start pose), centred on it, all heading as it does; or, with `formation: spiral`,
    on the spiral of Theodorus around it. Places that touch a solid, lie outside, are taken or cannot be reached from
    `start` are left out, and the next nearest places are used.

    Raises: PlacementError: a given pose touches a solid, lies outside or within another robot; no room is left.
    """
    if isinstance(robots, tuple):
        poses = [robot.start_pose for robot in robots]
        _check_poses(plan, poses, robots, [f"robots.{i}.start_pose" for i in range(len(poses))])
        return robots
    poses = list(robots.start_poses[: robots.count])
    _check_poses(plan, poses, [robots] * len(poses), [f"robots.start_poses.{i}" for i in range(len(poses))])
    if len(poses) < robots.count:
        poses += _formation(plan, robots, taken=poses)
    shared = {key: getattr(robots, key) for key in Robot.model_fields}
    at_start = robots.count - robots.reserve
    return tuple(PlacedRobot(**shared, start_pose=pose, present=i < at_start) for i, pose in enumerate(poses))


def check_places(plan: FloorPlan, robots: Team | tuple[PlacedRobot, ...], mission: Mission) -> None:
    """Raise PlacementError, which begins with the key, when a robot, area or victim stands where it cannot."""
    footprints = solids(plan)
    spots = [(f"mission.areas.{i}.center", area.center) for i, area in enumerate(mission.areas)]
    spots += [(f"mission.victims.{i}.position", victim.position) for i, victim in enumerate(mission.victims)]
    for key, point in spots:
        _check_inside(plan, key, point)
        hit = _solid_near(footprints, point, 0.0)
        if hit:
            raise PlacementError(f"{key}: {_text(point)} lies in {hit.kind} '{hit.name}'")
    placed_robots(plan, robots)


def _check_poses(plan: FloorPlan, poses: list[PlanarPose], robots: Sequence[Robot], keys: list[str]) -> None:
    footprints = solids(plan)
    reaches_m = [robot.reach_m for robot in robots]
    for i, (pose, robot, key) in enumerate(zip(poses, robots, keys, strict=True)):
        point = pose[:2]
        _check_inside(plan, key, point)
        hit = _solid_in(footprints, robot, pose)
        if hit:
            raise PlacementError(f"{key}: {_text(point)}: robot {i} {_of_radius(robot)}{_stands_in(hit)}")
        for j in range(i):
            is_near = math.dist(point, poses[j][:2]) < reaches_m[i] + reaches_m[j]
            if is_near and _are_there(robot, robots[j]) and _overlap(robot, pose, robots[j], poses[j]):
                raise PlacementError(f"{key}: {_text(point)}: robot {i} stands in robot {j}")


def _are_there(*robots: Robot) -> bool:
    """Whether all of them are there at the start."""
    return all(not isinstance(robot, PlacedRobot) or robot.present for robot in robots)


def _overlap(robot: Robot, pose: PlanarPose, other: Robot, other_pose: PlanarPose) -> bool:
    """Whether two robots overlap whose discs do."""
    if not robot.footprint_m and not other.footprint_m:
        return True
    return robot.body_at(pose).overlaps(other.body_at(other_pose), 0.0)


def _solid_in(footprints: tuple[Solid, ...], robot: Robot, pose: PlanarPose) -> Solid | None:
    """Return the first solid that a robot overlaps."""
    if not robot.footprint_m:
        return _solid_near(footprints, pose[:2], robot.radius_m)
    body = robot.body_at(pose)
    return next((solid for solid in footprints if body.overlaps_shape(solid.polygon, 0.0)), None)


def _of_radius(robot: Robot) -> str:
    return "" if robot.footprint_m else f"of radius {robot.radius_m:g} m "


def _check_inside(plan: FloorPlan, key: str, point: tuple[float, float]) -> None:
    if not plan.bounds.contains(point):
        raise PlacementError(f"{key}: {_text(point)} lies outside the plan, {plan.bounds}")


def _solid_near(footprints: tuple[Solid, ...], point: tuple[float, float], radius_m: float) -> Solid | None:
    """Return the first solid that a disc overlaps (radius 0: that holds the point)."""
    if not footprints:
        return None
    distances_m = shapely.distance([solid.polygon for solid in footprints], shapely.Point(point))
    hits = np.flatnonzero(distances_m < radius_m if radius_m else distances_m == 0.0)
    return footprints[hits[0]] if len(hits) else None


def _formation(plan: FloorPlan, team: Team, taken: list[PlanarPose]) -> list[PlanarPose]:
    """Return poses for the robots that have none: the free places nearest to the middle, front row first."""
    start = team.start or team.start_poses[0]
    wanted = team.count - len(taken)
    room = _Room(plan, start, team, taken)
    if team.formation == "spiral":
        return _spiral(plan, team, room, start, wanted)
    side, free = math.ceil(math.sqrt(wanted)), 0
    while (side - 1) * team.spacing_m <= 2.0 * math.dist(plan.bounds.min, plan.bounds.max):
        rows, columns = np.divmod(np.arange(side * side), side)
        # Twice the steps from the middle, as whole numbers: ties in distance stay ties on every machine.
        ahead, left = side - 1 - 2 * rows, side - 1 - 2 * columns
        points = _in_map_frame(start, 0.5 * team.spacing_m * ahead, 0.5 * team.spacing_m * left)
        places = np.flatnonzero(room.has_place(points))
        if len(places) >= wanted:
            nearest = places[np.argsort((ahead**2 + left**2)[places], kind="stable")[:wanted]]
            return [(float(x), float(y), start[2]) for x, y in points[np.sort(nearest)]]
        free = max(free, len(places))
        side = max(side + 1, side * 9 // 8)
    raise _no_room(team, start, free + len(taken))


def _spiral(plan: FloorPlan, team: Team, room: _Room, start: PlanarPose, wanted: int) -> list[PlanarPose]:
    """Return the first free places on the spiral of Theodorus around the start, from the middle outwards.

    The k-th place is sqrt(k) * spacing_m from the middle, and spacing_m from the one before [davis1993]: with the reach
    of a link for spacing_m, the team stands as wide as it can in one piece.
    """
    farthest = math.ceil((2.0 * math.dist(plan.bounds.min, plan.bounds.max) / team.spacing_m) ** 2)
    count = 4 * wanted
    poses: list[PlanarPose] = []
    while not poses or (len(poses) < wanted and count < 4 * farthest):
        k = np.arange(min(count, farthest))
        angle_rad = np.concatenate(([0.0, 0.0], np.cumsum(np.arctan(1.0 / np.sqrt(k[1:])))))[: len(k)]
        radius_m = team.spacing_m * np.sqrt(k)
        points = _in_map_frame(start, radius_m * np.cos(angle_rad), radius_m * np.sin(angle_rad))
        poses = [(float(x), float(y), start[2]) for x, y in points[room.has_place(points)]]
        count *= 4
    if len(poses) < wanted:
        raise _no_room(team, start, len(poses) + team.count - wanted)
    return poses[:wanted]


def _no_room(team: Team, start: PlanarPose, found: int) -> PlacementError:
    return PlacementError(
        f"robots.count: {team.count} robots {team.spacing_m:g} m apart find no room around {_text(start[:2])}, "
        f"only {found} of them"
    )


def _in_map_frame(start: PlanarPose, ahead_m: np.ndarray, left_m: np.ndarray) -> np.ndarray:
    """Return points given in the frame of `start` in the map frame, shape (n, 2)."""
    cos, sin = math.cos(start[2]), math.sin(start[2])
    return np.stack([start[0] + cos * ahead_m - sin * left_m, start[1] + sin * ahead_m + cos * left_m], axis=1)


class _Room:
    """The places where a team's robot can stand and that it can reach from the start."""

    def __init__(self, plan: FloorPlan, start: PlanarPose, team: Team, taken: list[PlanarPose]) -> None:
        key = "robots.start" if team.start else "robots.start_poses.0"
        _check_inside(plan, key, start[:2])
        hit = _solid_in(solids(plan), team, start)
        if hit:
            raise PlacementError(f"{key}: {_text(start[:2])}: a robot {_of_radius(team)}{_stands_in(hit)}")
        self._obstacles = obstacles(plan)
        self._radius_m = team.reach_m
        self._taken = shapely.MultiPoint([pose[:2] for pose in taken])
        self._bounds = plan.bounds
        longest_m = max(high - low for low, high in zip(plan.bounds.min, plan.bounds.max, strict=True))
        self._grid = occupancy_grid(plan, max(_REACH_RESOLUTION_M, longest_m / _MAX_REACH_CELLS))
        self._reached = self._flood(start)

    def has_place(self, points: np.ndarray) -> np.ndarray:
        """Return for each point, shape (n, 2), whether a robot can stand there; bool, shape (n,)."""
        keep_m = self._radius_m + CLEARANCE_M
        inside = np.all(
            (points >= np.array(self._bounds.min) + keep_m) & (points <= np.array(self._bounds.max) - keep_m), axis=1
        )
        free: np.ndarray = inside.copy()
        candidates = shapely.points(points[inside])
        clear = shapely.is_empty(self._obstacles) | (shapely.distance(self._obstacles, candidates) >= keep_m)
        alone = shapely.is_empty(self._taken) | (shapely.distance(self._taken, candidates) >= keep_m + self._radius_m)
        cells = [self._grid.cell_at(x, y) for x, y in points[inside]]
        reached = np.array([self._reached[cell] for cell in cells], dtype=bool)
        free[inside] = clear & alone & reached
        return free

    def _flood(self, start: PlanarPose) -> np.ndarray:
        """Return the cells that a robot reaches from the start, and two cells around them; bool, shape (rows, cols)."""
        from scipy import ndimage  # Takes longer to import than most scenarios, whose poses are given, take to load.

        free = self._grid.cells == FREE
        if not free.all():
            free = ndimage.distance_transform_edt(free) * self._grid.resolution_m > self._radius_m
        # The grid is conservative: the start's own cell may count as too near to a wall.
        labels, _ = ndimage.label(free)
        row, column = self._grid.cell_at(start[0], start[1])
        near = labels[max(row - 2, 0) : row + 3, max(column - 2, 0) : column + 3]
        reached: np.ndarray = ndimage.binary_dilation(np.isin(labels, near[near > 0]), iterations=2)
        return reached


def _stands_in(solid: Solid) -> str:
    return f"stands in {solid.kind} '{solid.name}'"


def _text(point: tuple[float, ...]) -> str:
    return f"[{', '.join(f'{value:g}' for value in point)}]"
