"""A lower bound on the time in which any team can save all victims, even one that knows where they are.

docs/benchmark.md has the proof. In short: no robot drives faster than its drive allows or through walls, so the time is
at least the longest route over the top speed; lengths of routes are bounded from below on a grid of optimistic cells.
"""

from __future__ import annotations

import math

import numpy as np
import shapely
from scipy import sparse
from scipy.sparse import csgraph

from robotteamsim.analysis.benchmark.routes import longest_route
from robotteamsim.errors import CampaignError
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.plan import obstacles
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.setup import Setup

OCTILE = math.cos(math.pi / 8.0)
"""The length of a straight line is at least this share of the shortest path of straight and diagonal steps."""

CONTACT_M = 0.02
"""Bodies in contact may overlap walls by less than this in the physics [m]."""

_VERTICES = 120_000
"""Size of the grid; finer grids give slightly higher bounds and take longer."""
_FINEST_M, _COARSEST_M = 0.05, 0.2


def search_bound(setup: Setup) -> float:
    """Return a lower bound on the time at which the last victim is saved [s]; infinity if one cannot be reached.

    Raises: CampaignError: a schedule, or victims who walk or flee, would change what the bound assumes.
    """
    scenario = setup.scenario
    if scenario.schedule:
        raise CampaignError(f"{scenario.name}: schedule: not allowed: the bound assumes that nothing is changed")
    if any(victim.walks or victim.flees for victim in scenario.mission.victims):
        raise CampaignError(f"{scenario.name}: mission.victims: the bound assumes that nobody walks")
    mission = scenario.mission
    robots = [robot for robot in setup.robots if robot.present]
    clearance_m = min(map(_narrowest_m, robots)) - CONTACT_M
    floor = setup.building.shared(OptimisticFloor, clearance_m, _burning_doors(scenario))
    starts_m = [robot.start_pose[:2] for robot in robots]
    victims_m = [victim.position for victim in mission.victims]
    from_starts, legs = floor.lengths_m(starts_m, victims_m, mission.save_distance_m)
    speed_mps = max(robot.drive.max_speed_mps for robot in robots)
    return longest_route(from_starts, legs) / speed_mps


class OptimisticFloor:
    """A grid on which paths are never longer than they must be.

    Cells are solid only if every point in them is too close to an obstacle for a robot's centre. The vertices of all
    other cells are linked to their eight neighbours along sides and diagonals of these cells. Paths of real robots have
    at least OCTILE times the length of the shortest path between vertices, minus the distances from the path's ends to
    them.
    """

    def __init__(self, building: Building, clearance_m: float, without_doors: frozenset[str] = frozenset()) -> None:
        """Args: clearance_m: of a robot's centre, at least.  without_doors: names of doors that are no obstacle."""
        plan = building.plan
        doors = tuple(door for door in plan.doors if door.name not in without_doors)
        solid_m = obstacles(plan.model_copy(update={"doors": doors}))
        (x_low, y_low), (x_high, y_high) = plan.bounds.min, plan.bounds.max
        width_m, height_m = x_high - x_low, y_high - y_low
        self.cell_m = min(max(math.sqrt(width_m * height_m / _VERTICES), _FINEST_M), _COARSEST_M)
        self._half_diagonal_m = self.cell_m * math.sqrt(0.5)
        # A ring of free cells around the plan, because a robot may leave a plan that is not closed.
        columns, rows = math.ceil(width_m / self.cell_m) + 2, math.ceil(height_m / self.cell_m) + 2
        low_m = np.array([x_low - self.cell_m, y_low - self.cell_m])
        x, y = np.meshgrid(
            low_m[0] + (np.arange(columns) + 0.5) * self.cell_m, low_m[1] + (np.arange(rows) + 0.5) * self.cell_m
        )
        nearer_m = clearance_m - self._half_diagonal_m
        solid = np.zeros((rows, columns), dtype=bool)
        if nearer_m > 0.0:
            inner = np.s_[1:-1, 1:-1]
            solid[inner] = shapely.dwithin(solid_m, shapely.points(x[inner], y[inner]), nearer_m)
        self._shape = rows + 1, columns + 1
        self._free = np.zeros(self._shape, dtype=bool)
        for row, column in ((0, 0), (0, 1), (1, 0), (1, 1)):
            self._free[row : row + rows, column : column + columns] |= ~solid
        self._graph = self._linked(~solid)
        column_of, row_of = np.meshgrid(np.arange(columns + 1), np.arange(rows + 1))
        self._places_m = np.stack([column_of, row_of], axis=-1).reshape(-1, 2) * self.cell_m + low_m

    def lengths_m(self, starts_m: list[Point], goals_m: list[Point], reach_m: float) -> tuple[np.ndarray, np.ndarray]:
        """Return lower bounds on the lengths of paths from starts to discs around goals, and between these discs.

        Returns: shapes (starts, goals) and (goals, goals); infinity where no path exists.
        """
        near_starts = [self._within(start_m, self._half_diagonal_m) for start_m in starts_m]
        near_goals = [self._within(goal_m, reach_m + self._half_diagonal_m) for goal_m in goals_m]
        from_starts = np.full((len(starts_m), len(goals_m)), math.inf)
        legs = np.full((len(goals_m), len(goals_m)), math.inf)
        for goal, vertices in enumerate(near_goals):
            if not len(vertices):
                continue
            away_m = csgraph.dijkstra(self._graph, indices=vertices, min_only=True)
            for start, others in enumerate(near_starts):
                from_starts[start, goal] = self._bound_m(away_m, others)
            for other, others in enumerate(near_goals):
                legs[goal, other] = self._bound_m(away_m, others)
        straight_m = np.hypot(*(np.array(starts_m).reshape(-1, 1, 2) - np.array(goals_m).reshape(1, -1, 2)).T).T
        between_m = np.hypot(*(np.array(goals_m).reshape(-1, 1, 2) - np.array(goals_m).reshape(1, -1, 2)).T).T
        return np.maximum(from_starts, straight_m - reach_m), np.maximum(legs, between_m - 2.0 * reach_m)

    def _bound_m(self, away_m: np.ndarray, vertices: np.ndarray) -> float:
        shortest_m = float(away_m[vertices].min()) if len(vertices) else math.inf
        return max(OCTILE * shortest_m - 2.0 * self._half_diagonal_m, 0.0)

    def _within(self, place_m: Point, radius_m: float) -> np.ndarray:
        """Return the indices of free vertices within a distance of a place."""
        away_m = np.hypot(*(self._places_m - place_m).T)
        return np.flatnonzero((away_m <= radius_m + 1e-9) & self._free.ravel())

    def _linked(self, free: np.ndarray) -> sparse.csr_matrix:
        """Return the lengths of steps along sides and diagonals of free cells, in both directions.

        Args: free: of all cells, bool, shape (rows - 1, columns - 1) of the vertices.
        """
        padded = np.pad(free, 1)
        index = np.arange(self._free.size).reshape(self._shape)
        begins, ends, lengths = [], [], []
        for first, second, passable, length in (
            (index[:, :-1], index[:, 1:], padded[:-1, 1:-1] | padded[1:, 1:-1], 1.0),
            (index[:-1], index[1:], padded[1:-1, :-1] | padded[1:-1, 1:], 1.0),
            (index[:-1, :-1], index[1:, 1:], free, math.sqrt(2.0)),
            (index[:-1, 1:], index[1:, :-1], free, math.sqrt(2.0)),
        ):
            begins += [first[passable], second[passable]]
            ends += [second[passable], first[passable]]
            lengths += [np.full(2 * int(passable.sum()), self.cell_m * length)]
        size = self._free.size
        return sparse.csr_matrix(
            (np.concatenate(lengths), (np.concatenate(begins), np.concatenate(ends))), (size, size)
        )


def _burning_doors(scenario: Scenario) -> frozenset[str]:
    """Return the names of the closed doors that a fire may open: for a lower bound they do not exist."""
    if scenario.fire is None:
        return frozenset()
    return frozenset(door.name for door in scenario.plan.doors if door.closed and scenario.fire.burns_through(door))


def _narrowest_m(robot: PlacedRobot) -> float:
    """Return how close the robot's centre can come to a wall [m]: the distance from it to the nearest side."""
    if not robot.footprint_m:
        return robot.radius_m
    body, centre = shapely.Polygon(robot.footprint_m), shapely.Point(0.0, 0.0)
    return float(body.exterior.distance(centre)) if body.contains(centre) else 0.0
