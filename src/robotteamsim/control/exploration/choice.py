"""Which place a robot explores next."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from robotteamsim.control.driving.known_map import GRID_RESOLUTION_M, KnownMap
from robotteamsim.control.exploration.frontiers import Goals, discount, frontier_cells, frontiers
from robotteamsim.control.exploration.patience import SAME_M, Patience
from robotteamsim.control.exploration.random_tree import RandomTree
from robotteamsim.control.runtime.streams import robot_stream
from robotteamsim.scenario.controllers.frontier import FrontierControl
from robotteamsim.scenario.sections import Area
from robotteamsim.setup import Setup
from robotteamsim.swarm import Vector

_CHANCES = 2
"""How often a frontier is tried before it is given up for good: a teammate may have been in the way."""


class Choice:
    """Chooses among the frontiers of a robot's map, and areas: these are worth as much unknown floor as they have."""

    def __init__(self, robot_id: int, setup: Setup, tuning: FrontierControl, arrival: int) -> None:
        """Args: arrival: number of the robot's arrivals, including the start."""
        self._tuning = tuning
        self._building, self._range_m = setup.map_of(robot_id), setup.robots[robot_id].laser.range_max_m
        self._searches = [frontier_cells]
        if tuning.choice == "rrt":
            rng = robot_stream(setup.scenario, "random_tree", robot_id, arrival)
            # Where the tree finds nothing, there may be something.
            self._searches.insert(0, RandomTree(setup.start_m(robot_id), rng).grow)
        self._chances = [Patience(tuning) for _ in range(_CHANCES)]
        self._last: Vector | None = None
        self.missed: set[Vector] = set()
        """The centres of areas to which the robot did not get."""

    def choose(
        self, known: KnownMap, position: Vector, areas: Sequence[Area], goals_of_team: Sequence[Vector], spent_s: float
    ) -> Vector | None:
        """Return the place to which the robot goes next, in `map` [m]; None if nothing is left.

        Args: areas:   to which it may go now.
              spent_s: how long it has been on the way to the last place.
        """
        last, self._last = self._last, None
        lengths_m = _lengths_m(known, position)
        if lengths_m is None:
            self.missed.update(area.center for area in areas)
            return None
        goals = self._frontiers(lengths_m).joined_with(self._ways_to(areas, known, lengths_m))
        self._last = self._try(goals, last, goals_of_team, spent_s)
        return self._last

    def way_to(self, area: Area, known: KnownMap, position: Vector, spent_s: float) -> Vector | None:
        """Return where the robot enters an area, in `map` [m], and note whether it misses it; None if it does.

        Args: spent_s: how long it has been on the way there.
        """
        lengths_m = _lengths_m(known, position)
        if lengths_m is None:
            self.missed.add(area.center)
            return None
        return self._try(self._ways_to([area], known, lengths_m), None, (), spent_s)

    def _try(self, goals: Goals, last: Vector | None, goals_of_team: Sequence[Vector], spent_s: float) -> Vector | None:
        """Return the best of the places that are not given up, and spend patience on it; None without one."""
        for patience in self._chances:
            left = goals.where(~patience.given_up(goals.places_m))
            if len(left):
                best = int(np.argmax(self._scores(left, last, goals_of_team)))
                x_m, y_m = left.places_m[best].tolist()
                patience.spend((x_m, y_m), float(left.paths_m[best]), spent_s)
                return x_m, y_m
        return None

    def _frontiers(self, lengths_m: np.ndarray) -> Goals:
        """Return the frontiers that are worth a path. Args: lengths_m: of the paths to all cells."""
        grid = self._building.grid(GRID_RESOLUTION_M)
        for search in self._searches:
            found = frontiers(grid, search(grid), lengths_m, self._range_m)
            found = found.where(found.gains_m2 >= self._tuning.least_gain_m2)
            if len(found):
                break
        return found

    def _ways_to(self, areas: Sequence[Area], known: KnownMap, lengths_m: np.ndarray) -> Goals:
        """Return the areas to which there is a path, and note which the robot misses."""
        places = [known.grid.nearest_free(area.center, area.radius_m) or area.center for area in areas]
        places_m = np.array(places).reshape(-1, 2)
        paths_m = np.array([known.grid.value_at(lengths_m, place) for place in places])
        is_open = np.isfinite(paths_m) & ~self._chances[-1].given_up(places_m)
        for area, is_this_open in zip(areas, is_open.tolist(), strict=True):
            (self.missed.discard if is_this_open else self.missed.add)(area.center)
        return Goals(places_m, paths_m, np.array([math.pi * area.radius_m**2 for area in areas])).where(is_open)

    def _scores(self, goals: Goals, last: Vector | None, goals_of_team: Sequence[Vector]) -> np.ndarray:
        """Return how good each place is, shape (n,). Args: last: the place so far."""
        tuning = self._tuning
        factor = discount(goals.places_m, goals_of_team if tuning.coordinated else (), self._range_m)
        if tuning.choice == "gain_over_path":
            scores = goals.gains_m2 * factor / (goals.paths_m + tuning.nearness_m)
        elif tuning.choice == "nearest":
            scores = factor / (goals.paths_m + tuning.nearness_m)
        else:
            scores = goals.gains_m2 * factor - tuning.path_cost_m * goals.paths_m
        if last is not None:
            is_last = np.hypot(*(goals.places_m - last).T) < SAME_M
            # A negative score becomes better by division.
            better = np.where(scores > 0.0, scores * tuning.hysteresis, scores / tuning.hysteresis)
            scores = np.where(is_last, better, scores)
        return np.asarray(scores)


def _lengths_m(known: KnownMap, position: Vector) -> np.ndarray | None:
    """Return the lengths of the paths from a robot to all cells [m]; None if nothing near it is free."""
    start = known.grid.nearest_free(position, 1.0)
    return None if start is None else known.distance_map(start)
