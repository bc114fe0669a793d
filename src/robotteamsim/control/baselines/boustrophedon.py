"""Boustrophedon: the team sweeps the floor in parallel lines, back and forth [choset2000]."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from robotteamsim.control.baselines.searching import RouteController
from robotteamsim.control.driving.known_map import GRID_RESOLUTION_M, known_map
from robotteamsim.control.driving.path_controller import Situation
from robotteamsim.errors import ScenarioError
from robotteamsim.interface.payload import Index, Update, update_reader
from robotteamsim.network.messages import EVERYBODY, Message
from robotteamsim.scenario.building import MapSource
from robotteamsim.scenario.controllers.routes import BoustrophedonControl
from robotteamsim.setup import Setup
from robotteamsim.swarm import Vector


class Swept(Update, frozen=True, tag="boustrophedon"):
    """The message of a robot that has swept its share."""

    robot_id: Index


parse_swept = update_reader(Swept, kept=1024)
"""Return what a teammate tells; None if it is another message."""


class BoustrophedonController(RouteController):
    """Sweeps its share of the floor, then those of the other robots in turn.

    All robots compute the same sweep from the start of robot 0 and begin at equal distances along it. A voice that is
    heard interrupts the sweep. A robot tells the others when it has swept its share.
    """

    def __init__(self, robot_id: int, setup: Setup) -> None:
        """Raises: ScenarioError: robot 0 cannot leave its start."""
        scenario = setup.scenario
        control = scenario.control.as_kind(BoustrophedonControl)
        super().__init__(robot_id, setup, control)
        spacing_m = control.spacing_m
        segments = setup.map_of(robot_id).shared(sweep, setup.robots[robot_id].reach_m, spacing_m, setup.start_m(0))
        if not segments:
            raise ScenarioError(
                f"{scenario.name}: control.spacing_m: no line of the sweep crosses floor that robots can reach"
            )
        self._places = [end for segment in segments for end in segment]
        begins = (*shares(segments, scenario.num_robots), len(segments))
        self._index = 2 * begins[robot_id]
        self._share = 2 * (begins[robot_id + 1] - begins[robot_id])
        """Number of places in its share."""
        self._num_done = 0
        """Number of places that it has reached or given up."""
        self._others = set(range(scenario.num_robots)) - {robot_id}
        """The robots that are not known to have swept their shares."""

    @property
    def is_searched(self) -> bool:
        """Whether all robots have swept their shares, or this one has swept the whole floor."""
        return self._num_done >= (len(self._places) if self._others else self._share)

    def _listen(self, inbox: Sequence[Message]) -> None:
        for message in inbox:
            swept = parse_swept(message.payload)
            if swept is not None:
                self._others.discard(swept.robot_id)

    def _look(self, now: Situation) -> tuple[Message, ...]:
        if self._num_done < self._share:
            return ()
        return (Message(self.robot_id, EVERYBODY, Swept(self.robot_id).to_json()),)

    def _next_place(self, position: Vector, is_done: bool) -> Vector:
        if is_done:
            self._index = (self._index + 1) % len(self._places)
            self._num_done += 1
        return self._places[self._index]


Segment = tuple[Vector, Vector]
"""The part of a line within one cell: its ends in `map` [m]."""


@dataclass(slots=True, eq=False)
class _Cell:
    """Segments on consecutive lines, each as (line, first column, last column), and the cells next to them."""

    runs: list[tuple[int, int, int]]
    neighbours: list[_Cell] = field(default_factory=list)


def sweep(building: MapSource, robot_radius_m: float, spacing_m: float, start: Vector) -> tuple[Segment, ...]:
    """Return the segments of all cells that a robot can reach from `start`, in the order of the sweep.

    Lines are parallel to the longer side of the plan and `spacing_m` apart. A cell ends at a line where the free floor
    splits, joins or ends. Cells are visited depth first along their neighbourhood, from the one nearest to the start.
    Empty if nothing can be reached.
    """
    plan, grid = building.plan, known_map(building, robot_radius_m).grid
    place = grid.nearest_free(start, 1.0)
    if place is None:
        return ()
    open_cells = np.isfinite(grid.distance_map(place))
    (x_low, y_low), (x_high, y_high) = plan.bounds.min, plan.bounds.max
    is_upright = y_high - y_low > x_high - x_low
    step = max(1, round(spacing_m / GRID_RESOLUTION_M))
    cells = _decompose(open_cells.T if is_upright else open_cells, step)

    def middle(line: int, column: int) -> Vector:
        x, y = (line, column) if is_upright else (column, line)
        return x_low + (x + 0.5) * GRID_RESOLUTION_M, y_low + (y + 0.5) * GRID_RESOLUTION_M

    ends = {id(cell): [(middle(line, a), middle(line, b)) for line, a, b in cell.runs] for cell in cells}
    segments: list[Segment] = []
    at = place
    for cell in _depth_first(
        cells, lambda cell: min(math.dist(place, end) for end in itertools.chain(*ends[id(cell)]))
    ):
        of_cell = ends[id(cell)]
        if _nearest_m(at, of_cell[-1]) < _nearest_m(at, of_cell[0]):
            of_cell = of_cell[::-1]
        for first, last in of_cell:
            segments.append((first, last) if math.dist(at, first) <= math.dist(at, last) else (last, first))
            at = segments[-1][1]
    return tuple(segments)


def shares(segments: tuple[Segment, ...], count: int) -> tuple[int, ...]:
    """Return the index of the first segment of each of `count` consecutive parts of about equal length."""
    lengths_m = [math.dist(*segment) for segment in segments]
    lengths_m = [
        length_m + (math.dist(before[1], segment[0]) if before else 0.0)
        for length_m, segment, before in zip(lengths_m, segments, (None, *segments), strict=False)
    ]
    begins_m = np.cumsum([0.0, *lengths_m[:-1]])
    wanted_m = sum(lengths_m) * np.arange(count) / count
    return tuple(int(np.argmin(np.abs(begins_m - wanted))) for wanted in wanted_m)


def _decompose(open_cells: np.ndarray, step: int) -> list[_Cell]:
    """Return the cells of a grid's open part, bool, shape (lines, columns), swept along every `step`-th line."""
    cells: list[_Cell] = []
    before: list[_Cell] = []
    last = -1
    for line in _lines(len(open_cells), step):
        runs = _runs(open_cells[line])
        joined = [[_touches(open_cells, last, line, cell.runs[-1][1:], run) for run in runs] for cell in before]
        current: list[_Cell] = []
        for index, (first, end) in enumerate(runs):
            above = [i for i, row in enumerate(joined) if row[index]]
            if len(above) == 1 and sum(joined[above[0]]) == 1:
                cell = before[above[0]]
                cell.runs.append((line, first, end))
            else:
                cell = _Cell([(line, first, end)])
                cells.append(cell)
                for i in above:
                    cell.neighbours.append(before[i])
                    before[i].neighbours.append(cell)
            current.append(cell)
        before, last = current, line
    return cells


def _lines(count: int, step: int) -> range:
    """Return the lines to sweep; the first is half a step from the border, if the plan is large enough."""
    return range(min(step // 2, count // 2), count, step)


def _runs(line: np.ndarray) -> list[tuple[int, int]]:
    """Return the first and the last column of each run of True."""
    changes = np.flatnonzero(np.diff(np.concatenate(([False], line, [False])).astype(np.int8)))
    return [(first, end - 1) for first, end in zip(changes[::2].tolist(), changes[1::2].tolist(), strict=True)]


def _touches(open_cells: np.ndarray, last: int, line: int, run: tuple[int, int], other: tuple[int, int]) -> bool:
    """Whether a straight free path across the lines connects a run of one line with a run of the next."""
    first, end = max(run[0], other[0]), min(run[1], other[1])
    return first <= end and bool(open_cells[last : line + 1, first : end + 1].all(axis=0).any())


def _depth_first(cells: list[_Cell], away_m: Callable[[_Cell], float]) -> list[_Cell]:
    """Return all cells, depth first from the nearest one; parts that are not connected follow by their distance."""
    order: list[_Cell] = []
    seen: set[int] = set()
    for first in sorted(cells, key=away_m):
        waiting = [first]
        while waiting:
            cell = waiting.pop()
            if id(cell) in seen:
                continue
            seen.add(id(cell))
            order.append(cell)
            waiting.extend(sorted(cell.neighbours, key=away_m, reverse=True))
    return order


def _nearest_m(place: Vector, segment: Segment) -> float:
    return min(math.dist(place, end) for end in segment)
