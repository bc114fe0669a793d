"""Start poses of a team's formation: free places around the start that robots can reach."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
import shapely

from robotteamsim import _core, rng
from robotteamsim.errors import PlacementError
from robotteamsim.scenario.base import PlanarPose
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.plan import FREE, obstacles
from robotteamsim.scenario.sections import PlacedRobot, Team
from robotteamsim.world.clearance import Solids, check_inside, overlaps, point_text

CLEARANCE_M = 0.05
"""Clearance between a formation's robots and solids, in addition to the radius."""

_REACH_RESOLUTION_M = 0.1
_DRAWN_AT_ONCE = 64
_MAX_REACH_CELLS = 2000
"""Largest number of cells along a side; the cells of larger plans are larger."""


def formation(
    building: Building,
    team: Team,
    taken: list[PlanarPose],
    *,
    others: Sequence[PlacedRobot] = (),
    section: str = "robots",
    seed: int = 0,
) -> list[PlanarPose]:
    """Return poses for the robots of a team that have none, all with the heading of the start.

    A square grid of `spacing_m` in the frame of `start` (without one: the first start pose), centred on it; or, with
    `formation: spiral`, the spiral of Theodorus around it. Places that touch a solid, are outside, are taken or cannot
    be reached from the start are skipped, and the next nearest places are used. The front row comes first.
    `formation: random` draws places and headings; those of the first robots do not depend on the number of robots.

    Args:   taken: poses of the team's other robots.
            others: robots of other teams, which it must not touch.
            section: key of the team, for errors.
            seed: of random poses.
    Raises: PlacementError: the start itself is not free, or there is not enough room.
    """
    plan, start = building.plan, team.start or team.start_poses[0]
    wanted = team.count - len(taken)
    room = _Room(building, start, team, taken, others, section)
    if team.formation == "random":
        return _random(team, room, start, wanted, rng.stream(seed, "random_starts", section))
    return (_spiral if team.formation == "spiral" else _square)(plan, team, room, start, wanted)


def _square(plan: FloorPlan, team: Team, room: _Room, start: PlanarPose, wanted: int) -> list[PlanarPose]:
    """Return the free places of a square grid that are nearest to the start, front row first."""
    side, free = math.ceil(math.sqrt(wanted)), 0
    while (side - 1) * team.spacing_m <= 2.0 * math.dist(plan.bounds.min, plan.bounds.max):
        rows, columns = np.divmod(np.arange(side * side), side)
        # Twice the steps from the centre, as whole numbers, so that ties in distance are ties on every machine.
        ahead, left = side - 1 - 2 * rows, side - 1 - 2 * columns
        points = _in_map_frame(start, 0.5 * team.spacing_m * ahead, 0.5 * team.spacing_m * left)
        places = np.flatnonzero(room.has_place(points))
        if len(places) >= wanted:
            nearest = places[np.argsort((ahead**2 + left**2)[places], kind="stable")[:wanted]]
            return [(float(x), float(y), start[2]) for x, y in points[np.sort(nearest)]]
        free = max(free, len(places))
        side = max(side + 1, side * 9 // 8)
    raise _no_room(room.section, team, start, free + team.count - wanted)


def _spiral(plan: FloorPlan, team: Team, room: _Room, start: PlanarPose, wanted: int) -> list[PlanarPose]:
    """Return the first free places on the spiral of Theodorus around the start, from the centre outwards.

    The k-th place is sqrt(k) * spacing_m from the centre, and spacing_m from the previous one [davis1993]: if spacing_m
    is the range of a link, the team covers the largest area in which it is still connected.
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
        raise _no_room(room.section, team, start, len(poses) + team.count - wanted)
    return poses[:wanted]


def _random(team: Team, room: _Room, start: PlanarPose, wanted: int, dice: np.random.Generator) -> list[PlanarPose]:
    """Return poses that are drawn one after the other, uniformly from all free cells that are not near a former one."""
    poses: list[PlanarPose] = []
    cells_m = dice.permutation(room.reached_m())
    for begin in range(0, len(cells_m), _DRAWN_AT_ONCE):
        points = cells_m[begin : begin + _DRAWN_AT_ONCE]
        for x, y in points[room.has_place(points)].round(3).tolist():
            if all(math.dist((x, y), pose[:2]) >= team.spacing_m for pose in poses):
                poses.append((x, y, float(dice.uniform(-math.pi, math.pi))))
                if len(poses) == wanted:
                    return poses
    raise _no_room(room.section, team, start, len(poses) + team.count - wanted)


def _no_room(section: str, team: Team, start: PlanarPose, found: int) -> PlacementError:
    key = f"{section}.count"
    text = f"{team.count} {section} {team.spacing_m:g} m apart do not fit around {point_text(start[:2])}"
    return PlacementError(f"{key}: {text}; there is room for {found}", key)


def _in_map_frame(start: PlanarPose, ahead_m: np.ndarray, left_m: np.ndarray) -> np.ndarray:
    """Return points given in the frame of `start` in the map frame, shape (n, 2)."""
    cos, sin = math.cos(start[2]), math.sin(start[2])
    return np.stack([start[0] + cos * ahead_m - sin * left_m, start[1] + sin * ahead_m + cos * left_m], axis=1)


class _Room:
    """The places where a robot of the team fits and that it can reach from the start."""

    def __init__(
        self,
        building: Building,
        start: PlanarPose,
        team: Team,
        taken: Sequence[PlanarPose],
        others: Sequence[PlacedRobot],
        section: str,
    ) -> None:
        self.section, plan = section, building.plan
        key = f"{section}.start" if team.start else f"{section}.start_poses.0"
        check_inside(plan, key, start[:2])
        hit = Solids(plan).under_robot(team, start)
        if hit:
            radius = "" if team.footprint_m else f"of radius {team.radius_m:g} m "
            raise PlacementError(f"{key}: {point_text(start[:2])}: a robot {radius}{overlaps(hit)}", key)
        self._obstacles = obstacles(plan)
        self._radius_m = team.reach_m
        self._taken = shapely.MultiPoint([pose[:2] for pose in (*taken, *(other.start_pose for other in others))])
        self._larger = [other for other in others if other.reach_m > self._radius_m]
        self._bounds = plan.bounds
        longest_m = max(high - low for low, high in zip(plan.bounds.min, plan.bounds.max, strict=True))
        self._grid = building.grid(max(_REACH_RESOLUTION_M, longest_m / _MAX_REACH_CELLS))
        self._reached = self._reached_from(start)

    def has_place(self, points: np.ndarray) -> np.ndarray:
        """Return for each point, shape (n, 2), whether a robot fits there; bool, shape (n,)."""
        keep_m = self._radius_m + CLEARANCE_M
        inside = np.all(
            (points >= np.array(self._bounds.min) + keep_m) & (points <= np.array(self._bounds.max) - keep_m), axis=1
        )
        free: np.ndarray = inside.copy()
        candidates = shapely.points(points[inside])
        clear = shapely.is_empty(self._obstacles) | (shapely.distance(self._obstacles, candidates) >= keep_m)
        alone = shapely.is_empty(self._taken) | (shapely.distance(self._taken, candidates) >= keep_m + self._radius_m)
        for other in self._larger:
            alone &= shapely.distance(shapely.Point(other.start_pose[:2]), candidates) >= keep_m + other.reach_m
        cells = [self._grid.cell_at(x, y) for x, y in points[inside]]
        reached = np.array([self._reached[cell] for cell in cells], dtype=bool)
        free[inside] = clear & alone & reached
        return free

    def reached_m(self) -> np.ndarray:
        """Return the centres of cells that a robot reaches from the start, and of some around them, shape (n, 2)."""
        rows, columns = np.nonzero(self._reached)
        steps = np.stack([columns, rows], axis=1) + 0.5
        centres_m: np.ndarray = steps * self._grid.resolution_m + np.array(self._grid.origin_m)
        return centres_m

    def _reached_from(self, start: PlanarPose) -> np.ndarray:
        """Return the cells that a robot reaches from the start, and two cells around them; bool, shape (rows, cols)."""
        edge_m, (origin_x, origin_y) = self._grid.resolution_m, self._grid.origin_m
        reach = math.ceil(self._radius_m / edge_m)
        blocked = _spread(self._grid.cells != FREE, reach, lambda y, x: np.sqrt(y**2 + x**2) * edge_m <= self._radius_m)
        paths = _core.plan.PlanningGrid(blocked, (origin_x, origin_y), edge_m, 0.0)
        rows, columns = blocked.shape
        row, column = self._grid.cell_at(start[0], start[1])
        reached = np.zeros_like(blocked)
        # The grid is conservative, so the start's own cell may count as too close to a wall.
        for i in range(max(row - 2, 0), min(row + 3, rows)):
            for j in range(max(column - 2, 0), min(column + 3, columns)):
                if not (reached[i, j] or blocked[i, j]):
                    middle = (origin_x + (j + 0.5) * edge_m, origin_y + (i + 0.5) * edge_m)
                    reached |= np.isfinite(paths.distance_map(middle))
        return _spread(reached, 2, lambda y, x: np.abs(y) + np.abs(x) <= 2)


def _spread(cells: np.ndarray, reach: int, is_near: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> np.ndarray:
    """Return the cells, bool, and all near them.

    Args: is_near: for the rows and columns between two cells, up to `reach` of each, whether they are near.
    """
    padded = np.pad(cells, reach)
    rows, columns = cells.shape
    spread = cells.copy()
    offsets = np.arange(-reach, reach + 1)
    for row, column in np.argwhere(is_near(offsets[:, None], offsets[None, :])):
        spread |= padded[row : row + rows, column : column + columns]
    return spread
