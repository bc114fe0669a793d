"""The areas that are still to be explored: how long that takes, what to keep out of, and who drives there early."""

from __future__ import annotations

import itertools
import math

import numpy as np

from robotteamsim import _core
from robotteamsim.control.driving.known_map import Disc
from robotteamsim.control.search.cells import NO_CELL, CellGrid
from robotteamsim.control.search.team import Teammates
from robotteamsim.interface import Task
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import Area
from robotteamsim.swarm import Vector

_KEPT_OUT_M = 0.3
"""Clearance from the last area, which ends the mission [m]."""


class RemainingAreas:
    """The areas that are left, in their order; the mission names the next one, or the robot's plan all of them.

    The last area ends the mission, so the team explores it when the search is done. Until then it keeps out of it.
    """

    def __init__(self, scenario: Scenario) -> None:
        self._all = self._areas = scenario.mission.areas
        self._next = 0
        self._center: Vector | None = None
        self.rivals: tuple[int, ...] | None = None
        """Ids of the teammates that go to the same next area; None: all do, as the mission names it."""

    def follow(self, task: Task) -> bool:
        """Adopt the mission's next area, or the robot's plan; return whether it has changed."""
        if task.areas_left is not None:
            before, self.rivals = self._areas, task.rivals
            self._areas = tuple(self._all[index] for index in task.areas_left)
            return self._areas != before
        if task.area_center_m == self._center:
            return False
        self._center = task.area_center_m
        following = [i for i, area in enumerate(self._areas) if i >= self._next and area.center == self._center]
        passed_over = [] if following else [area for area in self._all if area.center == self._center]
        if passed_over:
            self._areas, following = (passed_over[0],), [0]  # its turn comes again after all others
        self._next = following[0] if following else len(self._areas)
        return True

    @property
    def next(self) -> Area | None:
        """The next area; None if none is left."""
        return self._areas[self._next] if self._next < len(self._areas) else None

    @property
    def left(self) -> tuple[Area, ...]:
        """The areas that are still to be explored, the next one first."""
        return self._areas[self._next :]

    @property
    def num_left(self) -> int:
        """Number of areas that are still to be explored."""
        return len(self._areas) - self._next

    @property
    def is_last(self) -> bool:
        """Whether the next area is the last one."""
        return self.num_left == 1

    @property
    def kept_out(self) -> Disc | None:
        """The disc to keep out of until the search is done; a robot in the last area ends the mission at its turn."""
        if self.next is None:
            return None
        last = self._areas[-1]
        return last.center, last.radius_m + _KEPT_OUT_M

    @property
    def kept_out_soon(self) -> Disc | None:
        """That disc, when the last area is the next one or the one after it; a robot in it could not leave in time."""
        return self.kept_out if self.num_left <= 2 else None

    def nearest_outside(self, place: Vector) -> Vector:
        """Return the nearest place that does not end the mission: another one only if the last area is the next."""
        if not self.is_last or self.kept_out is None:
            return place
        center, radius_m = self.kept_out
        away_m = math.dist(center, place)
        if away_m >= radius_m or away_m == 0.0:
            return place
        stretch = radius_m / away_m
        return center[0] + stretch * (place[0] - center[0]), center[1] + stretch * (place[1] - center[1])

    def would_end(self, start: Vector, end: Vector) -> bool:
        """Whether a straight line leads through the last area at its turn."""
        if not self.is_last or self.kept_out is None:
            return False
        center, radius_m = self.kept_out
        return _distance_to_segment(center, start, end) < radius_m - 0.5 * _KEPT_OUT_M


class Areas(RemainingAreas):
    """The areas in their order, and the paths to them."""

    def __init__(self, scenario: Scenario, grid: CellGrid) -> None:
        super().__init__(scenario)
        self._grid = grid
        self.cell = NO_CELL
        """The cell from which the next area can be explored; NO_CELL if there is none."""
        self._is_measured = False
        """Whether the cells were found from a place of the robot on free floor."""
        self._later_cells: list[int] = []
        """The cells of the areas after the next one."""
        self.tour_m = 0.0
        """The length of the path from the next area through all others [m]."""
        self.last_leg_m = 0.0
        """The length of the path from the area before the last one to the last one [m]."""

    def measure(self, paths: _core.control.CellPaths, start: int) -> None:
        """Find the cells of the remaining areas that a robot can reach from a cell, and the length of the tour."""
        self._is_measured = start != NO_CELL
        cells = [self.cell_in(area, paths, start) for area in self.left]
        self.cell = cells[0] if cells else NO_CELL
        self._later_cells = cells[1:]
        reached = [cell for cell in cells if cell != NO_CELL]
        legs_m = [paths.length_m(a, b) for a, b in itertools.pairwise(reached)]
        self.tour_m = sum(length_m for length_m in legs_m if math.isfinite(length_m))
        self.last_leg_m = legs_m[-1] if legs_m and math.isfinite(legs_m[-1]) else 0.0

    @property
    def closed_center_m(self) -> Vector | None:
        """The centre of the next area if no path to it was found, in `map` [m]; else None."""
        return self.next.center if self.next is not None and self._is_measured and not self.is_possible else None

    @property
    def must_be_measured(self) -> bool:
        """Whether the robot was not on free floor when the cells were looked for."""
        return not self._is_measured

    @property
    def last_cell(self) -> int:
        """The cell from which the last area can be explored; NO_CELL if there is none."""
        return self._later_cells[-1] if self._later_cells else self.cell

    @property
    def is_possible(self) -> bool:
        """Whether there is a next area, and a robot can reach it."""
        return self.cell != NO_CELL

    def middle_cell(self, index: int) -> int:
        """Return the cell of an area between the next and the last one, the first at 0; NO_CELL if there is none."""
        middle = self._later_cells[:-1]
        return middle[index] if index < len(middle) else NO_CELL

    def cell_beside(self, outside: _core.control.CellPaths, start: int) -> int:
        """Return the reachable cell that is nearest to the last area; NO_CELL if there is none.

        Args: outside: paths outside the area.  start: the cell of the robot.
        """
        reached = np.flatnonzero(np.isfinite(outside.lengths_from(start)))
        return self._grid.nearest(reached, self._areas[-1].center)

    def cell_in(self, area: Area, paths: _core.control.CellPaths, start: int) -> int:
        """Return the reachable cell whose place is nearest to the middle of an area and inside it; else NO_CELL."""
        if start < 0:
            return NO_CELL
        lengths_m = paths.lengths_from(start)
        best, nearest_m = NO_CELL, area.radius_m
        reach = math.ceil(area.radius_m / self._grid.cell_m) + 1
        middle_row, middle_column = divmod(paths.cell_of(area.center), self._grid.columns)
        for row in range(max(middle_row - reach, 0), min(middle_row + reach + 1, self._grid.rows)):
            for column in range(max(middle_column - reach, 0), min(middle_column + reach + 1, self._grid.columns)):
                cell = row * self._grid.columns + column
                place = paths.place_of(cell)
                if place is None or not math.isfinite(lengths_m[cell]):
                    continue
                away_m = math.dist(place, area.center)
                if away_m < nearest_m:
                    best, nearest_m = cell, away_m
        return best


def shut_cells(
    paths: _core.control.CellPaths, outside: _core.control.CellPaths, start_m: Vector, num_cells: int
) -> np.ndarray:
    """Return the cells that cannot be reached without entering the last area, bool.

    Args: paths: all.  outside: outside the area.  start_m: of a robot, in `map` [m].
    """
    start, start_outside = paths.start_of(start_m), outside.start_of(start_m)
    if start == NO_CELL:
        return np.zeros(num_cells, dtype=bool)
    reached = np.isfinite(paths.lengths_from(start))
    return reached if start_outside == NO_CELL else reached & ~np.isfinite(outside.lengths_from(start_outside))


def _distance_to_segment(point: Vector, start: Vector, end: Vector) -> float:
    """Return the distance of a point to a straight line [m]."""
    along = np.subtract(end, start)
    square = float(along @ along)
    share = float(np.clip(np.subtract(point, start) @ along / square, 0.0, 1.0)) if square > 0.0 else 0.0
    return math.dist(point, (start[0] + share * along[0], start[1] + share * along[1]))


_OVERHEAD = 4.0
"""The end of a search takes this many times as long as if no floor were heard twice and every drive led over new floor;
chosen with the seeds 1 to 20 of the garage."""

_HYSTERESIS = 0.7
"""A robot that already drives to the last area stops only if its path is at most this share of the allowed length."""


class EarlyDrive:
    """Whether one robot drives to the last area early, so that the team does not wait for it at the end."""

    def __init__(self) -> None:
        self._is_on = False

    def is_needed(
        self, areas: Areas, team: Teammates, paths: _core.control.CellPaths, start: int, search_m: float
    ) -> bool:
        """Return whether the robot drives to the last area now.

        It does if it is the nearest one, and its path is longer than both that through the areas before the last one
        and that until the search is over.

        Args: start: the cell of the robot.
              search_m: how far each robot drives until the team has searched the remaining floor, if all goes well [m].
        """
        was_on, self._is_on = self._is_on, False
        if areas.num_left < 2 or not areas.is_possible or areas.last_cell == NO_CELL or start == NO_CELL:
            return False
        length_m, robot_id = min(team.lengths_m(areas.last_cell, start, paths, ("search", "voice", "wait")))
        to_next_m, _ = min(team.lengths_m(areas.cell, start, paths))
        allowed_m = max(to_next_m + areas.tour_m - areas.last_leg_m, _OVERHEAD * search_m)
        self._is_on = robot_id == team.robot_id and length_m > (_HYSTERESIS if was_on else 1.0) * allowed_m
        return self._is_on
