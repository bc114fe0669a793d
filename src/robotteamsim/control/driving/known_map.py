"""The map that a robot knows: free space for its body in the plan, and lengths of free paths."""

import itertools
import math

import numpy as np

from robotteamsim import _core
from robotteamsim.control.driving.hot_places import with_hot_blocks
from robotteamsim.scenario.building import Doors, MapSource
from robotteamsim.scenario.fire import Block
from robotteamsim.scenario.levels import Traveller
from robotteamsim.scenario.plan import OCCUPIED, Grid, OccupancyGrid
from robotteamsim.swarm import Vector

GRID_RESOLUTION_M = 0.1
"""Half of the smallest body's radius, so that a doorway that a robot fits through stays open in the grid."""

MARGIN_M = 0.05
"""Clearance between a robot's body and the plan, in addition to that of the conservative occupancy grid."""

Disc = tuple[Vector, float]
"""Centre in `map` and radius [m]."""

UNREACHABLE_M = 1e4
"""Added to the straight distance if there is no free path to a goal, so that any reachable place is better."""

_POINTS_PER_RADIUS = 40
"""A disc is looked at in so many points per radius, or in all cells of the grid."""

_KEPT_DISTANCE_MAPS = 64
"""Of goals, and of discs: more than a mission has areas and a patrol vertices."""


class KnownMap:
    """Free space of one plan for one size of robot, with doors and hot places as believed.

    Results depend only on places and doors, not on earlier calls. Distance maps are cached because they are expensive.

    layout: where the cells are in `map`.
    by:     who goes between levels by the passages: robots, or people and firefighters.
    grid:   which cells are free for the robot's centre, and paths through them and by passages between levels.
    """

    def __init__(
        self,
        building: MapSource,
        robot_radius_m: float,
        doors: Doors,
        hot: tuple[Block, ...] = (),
        kept_out: Disc | None = None,
        by: Traveller = "robots",
    ) -> None:
        occupancy, clearance_m = building.grid(GRID_RESOLUTION_M, doors), robot_radius_m + MARGIN_M
        cells = with_hot_blocks(occupancy, hot) if hot else occupancy.cells
        blocked = cells == OCCUPIED  # robots try what they do not know
        if kept_out is not None:
            _block(blocked, occupancy, kept_out, clearance_m)
        self.layout = Grid(occupancy.origin_m, GRID_RESOLUTION_M)
        self.grid = _core.plan.PlanningGrid(
            blocked, occupancy.origin_m, GRID_RESOLUTION_M, clearance_m, building.portals(by)
        )
        self._distance_maps: dict[Vector, np.ndarray | None] = {}
        self._pieces: dict[tuple[Vector, float], list[np.ndarray]] = {}

    def distance_map(self, goal: Vector) -> np.ndarray | None:
        """Return the length of the path between each cell and the free one nearest to a goal, float32 [m].

        inf: there is no path. None: no cell within 5 m is free. It is kept: do not change it.
        """
        distances = self._distance_maps.get(goal)
        if distances is None and goal not in self._distance_maps:
            while len(self._distance_maps) >= _KEPT_DISTANCE_MAPS:
                del self._distance_maps[next(iter(self._distance_maps))]
            free_goal = self.grid.nearest_free(goal, 5.0)
            distances = self._distance_maps[goal] = None if free_goal is None else self.grid.distance_map(free_goal)
        return distances

    def distance_m(self, goal: Vector, position: Vector) -> float:
        """Return the length of the shortest free path [m]; UNREACHABLE_M and the straight distance without one."""
        distances = self.distance_map(goal)
        start = self.grid.nearest_free(position, 1.0)
        length_m = self.grid.value_at(distances, start) if distances is not None and start is not None else math.inf
        return length_m if math.isfinite(length_m) else UNREACHABLE_M + math.dist(goal, position)

    def distances_m(self, goal: Vector, positions_m: np.ndarray) -> np.ndarray:
        """Return `distance_m` of each of several positions, shape (..., 2) [m]; shape (...)."""
        distances, places_m = self.distance_map(goal), positions_m.reshape(-1, 2)
        lengths_m = np.full(len(places_m), np.inf)
        if distances is not None:
            lengths_m = self.grid.values_near(distances, places_m, 1.0)
        for row in np.flatnonzero(~np.isfinite(lengths_m)).tolist():
            lengths_m[row] = UNREACHABLE_M + math.dist(goal, places_m[row])
        return lengths_m.reshape(positions_m.shape[:-1])

    def has_path(self, start: Vector, goal: Vector, longest_m: float) -> bool:
        """Whether a free path of at most `longest_m` leads between two free places, in `map` [m]."""
        distances = self._distance_maps.get(start)
        if distances is None:
            return bool(self.grid.waypoints(start, goal, longest_m))
        return self.grid.value_at(distances, goal) <= longest_m

    def reaches(self, start: Vector, center: Vector, radius_m: float) -> bool:
        """Whether a free path leads from a free place into a disc. Places in `map` [m]."""
        return any(math.isfinite(self.grid.value_at(piece, start)) for piece in self._pieces_of(center, radius_m))

    def nearest_by_path(self, goal: Vector, position: Vector, radius_m: float) -> tuple[Vector, float]:
        """Return the cell near a robot with the shortest path to a goal, and the length of that path [m].

        The cells are those that the robot can reach within `radius_m`. If the goal cannot be reached, the cell with the
        smallest straight distance to it is returned, with the length from `distance_m`.
        """
        distances = self.distance_map(goal)
        start = self.grid.nearest_free(position, 1.0)
        if distances is not None and start is not None:
            best = self.grid.least_reachable(distances, start, radius_m)
            if best is not None:
                return best
        cell = self.nearest_by_sight(goal, position, radius_m)
        return cell, self.distance_m(goal, cell)

    def nearest_by_sight(self, goal: Vector, position: Vector, radius_m: float) -> Vector:
        """Return the free cell within `radius_m` of a robot with the smallest straight distance to a goal."""
        cell = self.grid.nearest_in_disc(position, goal, radius_m)
        return position if cell is None else cell

    def _pieces_of(self, center: Vector, radius_m: float) -> list[np.ndarray]:
        """Return a distance map of each separate piece of the free floor in a disc, float32, shape (rows, cols) [m]."""
        if (center, radius_m) not in self._pieces:
            while len(self._pieces) >= _KEPT_DISTANCE_MAPS:
                del self._pieces[next(iter(self._pieces))]
            pieces: list[np.ndarray] = []
            spacing_m = max(GRID_RESOLUTION_M, radius_m / _POINTS_PER_RADIUS)
            offsets_m = np.arange(-radius_m, radius_m + 0.5 * spacing_m, spacing_m).tolist()
            for x_m, y_m in itertools.product(offsets_m, offsets_m):
                point = center[0] + x_m, center[1] + y_m
                if math.hypot(x_m, y_m) > radius_m or not self.grid.is_free(point):
                    continue
                if all(math.isinf(self.grid.value_at(piece, point)) for piece in pieces):
                    pieces.append(self.grid.distance_map(point))
            self._pieces[center, radius_m] = pieces
        return self._pieces[center, radius_m]


def known_map(
    building: MapSource,
    robot_radius_m: float,
    doors: Doors = (),
    hot: tuple[Block, ...] = (),
    kept_out: Disc | None = None,
    by: Traveller = "robots",
) -> KnownMap:
    """Return the map for a building and a robot's radius [m], with doors that are believed to differ from the plan.

    Robots share it: its contents depend only on these values.

    Args: hot:      places that count as occupied.
          kept_out: a disc that the robot's centre enters by at most one cell.
          by:       who goes between levels: robots, or people and firefighters.
    """
    return building.shared(KnownMap, robot_radius_m, doors, hot, kept_out, by)


def _block(blocked: np.ndarray, occupancy: OccupancyGrid, disc: Disc, clearance_m: float) -> None:
    """Block cells of a grid so that robots with that clearance keep out of a disc, to a cell."""
    (x, y), radius_m = disc
    # At least the cell in the middle.
    reach_m = max(radius_m - clearance_m, occupancy.resolution_m)
    y_m, x_m = (
        low + (np.arange(size) + 0.5) * occupancy.resolution_m - at
        for low, size, at in zip(occupancy.origin_m[::-1], blocked.shape, (y, x), strict=True)
    )
    rows, columns = np.flatnonzero(np.abs(y_m) <= reach_m), np.flatnonzero(np.abs(x_m) <= reach_m)
    blocked[np.ix_(rows, columns)] |= np.hypot(x_m[columns], y_m[rows, None]) <= reach_m
