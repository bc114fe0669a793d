"""A team that searches and stays connected: goals that are linked, ways that break no link that is needed, and help.

Each robot predicts links from the plan alone, and uses its own position and the last messages of its teammates;
docs/search.md has the equations.

1. Goals. Robots are ranked by their work: who approaches a voice goes first, then who explores an area, then who
   searches; of equal ones, the lower id. A robot listens, and explores areas, only at places linked to the goal of a
   robot that goes first.
2. Ways. A robot drives only over cells in which it stays connected with all others with whom it is, where they are now.
3. Help. If a robot that goes first would lose others where it wants to go, they come nearer: to the first of those
   whom they can help. A robot that has been held for long goes first in this.
4. Healing. If a teammate falls silent, the robot drives back to where it last heard all others.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import msgspec
import numpy as np

from robotteamsim import _core
from robotteamsim.control.search.cells import NO_CELL, CellGrid, cell_paths
from robotteamsim.control.search.team import SearchUpdate, Teammates, Work
from robotteamsim.network.delivery import loss_probability
from robotteamsim.propagation import RadioField
from robotteamsim.scenario.building import Doors, MapSource
from robotteamsim.scenario.controllers.search import SearchControl
from robotteamsim.scenario.sections import Network, Radio
from robotteamsim.setup import Setup
from robotteamsim.swarm import Vector

_RANKS: Mapping[Work, int] = {"voice": 0, "area": 1, "search": 2, "wait": 3}
"""Which work goes first."""

_WANTED_CELLS = 10
"""How many cells ahead a robot announces where it wants to be, so that others can come in time; chosen in the garage
with seeds 1 to 26, as is the patience."""

_STEP_M = 1.0
"""Within this distance a place beside the robot is judged [m]."""

_PATIENCE_S = 5.0
"""A robot that is held for longer relies on links that are only likely, until it was not held for as long [s]."""

_MOST_LOST = 0.25
"""A link that loses a larger share of the messages is not relied on: positions would be too old."""

_LATE, _SILENT = 1.5, 3.5
"""A teammate was heard recently if in the last 1.5 iterations; it is lost if not in the last 3.5."""

_AHEAD_M = 8.0
"""A robot drives to the farthest place on its way that it can reach in a straight line, within this length [m]."""

_LONGEST_DETOUR = 2.0
"""A way over cells that keep the team connected is at most so many times as long as the shortest; else others help."""

CellWay = tuple[list[int], Vector]
"""The cells of a way, the robot's own one first, and the place to drive to now, in `map` [m]."""

_BASE = -1
"""The rank and id of the base, which goes before all robots, because it cannot come."""


def predicted_links(
    building: MapSource,
    robot_radius_m: float,
    grid: CellGrid,
    doors: Doors,
    radio_json: str,
    network: Network,
    margin_db: float,
) -> tuple[np.ndarray, np.ndarray]:
    """Return which links between cells are sure, and which are likely: two arrays of bool, shape (cells, cells).

    A likely link is one between the places of two cells, with a margin. It is sure if all links from each neighbour of
    one cell to each neighbour of the other are likely: positions of teammates are old, and all robots move. Cells
    without a free place have no links.
    """
    paths = cell_paths(building, robot_radius_m, grid, doors, None)
    free = np.array([cell for cell in range(grid.size) if paths.place_of(cell) is not None])
    places_m = np.array([paths.place_of(int(cell)) for cell in free])
    if network.link == "distance":
        x_m, y_m = places_m.T
        is_link = np.hypot(x_m - x_m[:, None], y_m - y_m[:, None]) <= network.max_distance_m
    else:
        field = RadioField(building.plan, Radio.model_validate_json(radio_json))
        for name, closed in doors:
            field.set_door(name, closed)
        rssi_dbm = field.rssi_matrix_dbm(places_m)
        is_link = (rssi_dbm >= network.lost_below_dbm + margin_db) & (loss_probability(rssi_dbm, network) <= _MOST_LOST)
    np.fill_diagonal(is_link, True)
    links = np.ones((grid.size, grid.size), dtype=bool)
    links[np.ix_(free, free)] = is_link
    is_free = np.zeros(grid.size, dtype=bool)
    is_free[free] = True
    both = is_free & is_free[:, None]
    return _of_all_neighbours(_of_all_neighbours(links, grid).T, grid) & both, links & both


def _of_all_neighbours(links: np.ndarray, grid: CellGrid) -> np.ndarray:
    """Return for each cell the links that it and all cells around it have."""
    rows = np.pad(links.reshape(grid.rows, grid.columns, -1), ((1, 1), (1, 1), (0, 0)), constant_values=True)
    both: np.ndarray = rows[1:-1, 1:-1] & rows[:-2, 1:-1] & rows[2:, 1:-1] & rows[1:-1, :-2] & rows[1:-1, 2:]
    return np.ascontiguousarray(both.reshape(links.shape))


@dataclass(frozen=True, slots=True)
class _Placing:
    """Where the others are or may be: a cell of each by id; `head` is the one to whom all keep their links."""

    cells: Mapping[int, int]
    head: int


@dataclass(frozen=True, slots=True)
class _Step:
    """Where a robot drives now, in `map` [m], None if it is held; and the cell where it wants to be, or NO_CELL."""

    ahead: Vector | None
    wanted: int


class _Patience:
    """Whether a robot has been held for some time, and has not moved for as long since."""

    def __init__(self, limit_s: float) -> None:
        self._limit_s = limit_s
        self._held_s = 0.0
        self.is_out = False

    def note(self, change_s: float) -> None:
        """Note for how long the robot was held; below 0, for how long it was not [s]."""
        self._held_s = min(max(self._held_s + change_s, 0.0), self._limit_s)
        self.is_out = self._held_s == self._limit_s or (self.is_out and self._held_s > 0.0)


class ConnectedTeam:
    """What one robot does to stay connected with its team."""

    def __init__(self, robot_id: int, setup: Setup, grid: CellGrid, team: Teammates) -> None:
        scenario = setup.scenario
        self._tuning = scenario.control.as_kind(SearchControl)
        self._robot_id, self._grid, self._team, self._building = robot_id, grid, team, setup.map_of(robot_id)
        self._reach_m, self._network = setup.robots[robot_id].reach_m, scenario.network
        self._radio_json = scenario.radio.model_dump_json()
        self._base_m = None if scenario.base is None else setup.start_m(scenario.base)
        self._base_cell = NO_CELL
        self._everywhere = np.ones(grid.size, dtype=bool)
        self._home = NO_CELL
        """The cell where the robot was when it last heard all others; NO_CELL once it has been there again."""
        self._patience = _Patience(_PATIENCE_S)
        self._long_patience = _Patience(self._tuning.progress_timeout_s)
        self.wanted = NO_CELL
        """The cell where it wants to be next; NO_CELL if it stands still."""
        self.waits = False
        """Whether it stands still so that those who are apart can come."""

    def use(self, doors: Doors, paths: _core.control.CellPaths) -> None:
        """Predict links with doors as they are believed to be now."""
        key = (self._reach_m, self._grid, doors, self._radio_json, self._network, self._tuning.link_margin_db)
        self._sure, self._likely = self._building.shared(predicted_links, *key)
        if self._base_m is not None:
            self._base_cell = paths.start_of(self._base_m)

    def linked(self, work: Work) -> np.ndarray | None:
        """Return the cells that a robot with this work may choose, bool; None: all, if nobody goes first.

        They are linked to the goal of a robot that goes first, or would be by the relays that have nothing to do.
        """
        first = [self._base_cell, *(u.goal if u.goal != NO_CELL else u.at for u in self._before(work))]
        first = [cell for cell in first if cell != NO_CELL]
        if not first:
            return None
        found = np.asarray(self._sure[first].any(axis=0))
        own = self._rank(work, self._robot_id)
        for update in self._team.updates:
            if update.work == "wait" and self._rank(update.work, update.robot_id) > own:
                found = np.asarray(self._sure[found].any(axis=0))
        return found

    @property
    def is_long_held(self) -> bool:
        """Whether this robot has been held for so long that all others help it."""
        return self._long_patience.is_out

    def is_behind(self, work: Work) -> bool:
        """Whether another robot goes before this one with this work."""
        return bool(self._before(work))

    def steer(
        self,
        position: Vector,
        at: int,
        work: Work,
        goal: int,
        target: Vector | None,
        paths: _core.control.CellPaths,
        time_s: float,
    ) -> Vector | None:
        """Return where the robot drives now, so that the team stays connected; None: it stands still.

        Args: position: in `map` [m], in the cell `at`.  goal: the cell to which it drives; NO_CELL if there is none.
              target: where it would drive now [m], to the goal or to a place beside it; None: it would stand still.
        """
        self.wanted, self.waits = NO_CELL, False
        if at == NO_CELL:
            return target
        iteration_s = self._tuning.iteration_s
        if silent := self._team.silent(time_s, _SILENT * iteration_s):
            return self._way_back(position, at, min(silent), paths)
        if not self._team.silent(time_s, _LATE * iteration_s):
            self._home = at
        placings = self._placings(work)
        connecting = [self._connecting(placing, self._sure) for placing in placings]
        allowed = self._keeping(at, placings[0], self._likely)
        if not self._patience.is_out:
            kept = [self._keeping(at, placings[0], self._sure), *(cells for cells in connecting if cells[at])]
            allowed = np.all([allowed, *kept], axis=0)
        helps = [
            self._help(position, at, placing, cells, allowed, paths)
            for placing, cells in zip(placings, connecting, strict=True)
            if not cells[at] and not self._is_with_head(placing, at)
        ]
        if helps:
            step = next((step for step in helps if step.ahead is not None), helps[0])
        elif target is None or not connecting[0][at]:
            step = _Step(None, NO_CELL)
            self.waits = target is not None  # Those come who are apart.
        else:
            step = self._step_to(goal, target, position, allowed, paths)
        self.wanted = step.wanted
        self._note(is_held=step.ahead is None and step.wanted != NO_CELL)
        return step.ahead

    def _step_to(
        self, goal: int, target: Vector, position: Vector, allowed: np.ndarray, paths: _core.control.CellPaths
    ) -> _Step:
        """Return the step to the goal, or straight to the target if there is none."""
        if goal == NO_CELL:
            cell = self._cell_towards(position, target, paths)
            return _Step(target if cell == NO_CELL or allowed[cell] else None, cell)
        goals = ~self._everywhere
        goals[goal] = True
        way = self._way(position, (goals,), allowed, paths)
        return _Step(target, NO_CELL) if way is None else _step_on(way, allowed)

    def _help(
        self,
        position: Vector,
        at: int,
        placing: _Placing,
        connecting: np.ndarray,
        allowed: np.ndarray,
        paths: _core.control.CellPaths,
    ) -> _Step:
        """Return the step to the nearest place, nearer to the head of a placing, that connects all, or else both."""
        part = self._part_of(placing.head, placing.cells, self._sure)
        linked = self._sure[[placing.cells[i] for i in part]].any(axis=0)
        to_head_m = paths.lengths_from(placing.cells[placing.head])
        linked &= (to_head_m < to_head_m[at]) | ~np.isfinite(to_head_m[at])
        way = self._way(position, (connecting & linked, linked), allowed, paths)
        return _Step(None, NO_CELL) if way is None else _step_on(way, allowed)

    def _way(
        self, position: Vector, goals: Sequence[np.ndarray], allowed: np.ndarray, paths: _core.control.CellPaths
    ) -> CellWay | None:
        """Return the way over allowed cells to the nearest of the first goals that have one without a long detour.

        Otherwise it is the shortest way to the nearest of the last ones; None if there is none, or they are reached.
        """
        shortest = paths.way_within(position, goals[-1], self._everywhere, _AHEAD_M)
        if shortest is None or len(shortest[0]) < 2:
            return None
        for cells in goals:
            way = paths.way_within(position, cells & allowed, allowed, _AHEAD_M)
            if way is not None and 1 < len(way[0]) <= _LONGEST_DETOUR * len(shortest[0]):
                return way
        return shortest

    def _way_back(self, position: Vector, at: int, lost: int, paths: _core.control.CellPaths) -> Vector | None:
        """Return the way to where the robot last heard all; from there on, to where a lost one with a lower id was."""
        if self._home == at:
            self._home = NO_CELL
        goal = self._home
        if goal == NO_CELL and lost < self._robot_id:
            goal = next(update.at for update in self._team.updates if update.robot_id == lost)
        return None if goal in (NO_CELL, at) else paths.ahead(position, goal, _AHEAD_M)

    def _note(self, *, is_held: bool) -> None:
        for patience in (self._patience, self._long_patience):
            patience.note(self._tuning.iteration_s if is_held else -self._tuning.iteration_s)

    @staticmethod
    def _rank(work: Work, robot_id: int) -> tuple[int, int]:
        return _RANKS[work], robot_id

    def _before(self, work: Work, *, helped: bool = False) -> list[SearchUpdate]:
        """Return the updates of those that go before this robot with its work, the first one first.

        Args: helped: those that have been held for long, too: all of them, unless this robot has been held as well.
        """
        own = self._rank(work, self._robot_id)
        held = {update.robot_id for update in self._team.updates if helped and update.held is True}
        first = set() if self.is_long_held else held
        before = [u for u in self._team.updates if u.robot_id in first or self._rank(u.work, u.robot_id) < own]
        return sorted(before, key=lambda u: (u.robot_id not in held, *self._rank(u.work, u.robot_id)))

    def _placings(self, work: Work) -> list[_Placing]:
        """Return the team as it is, and as it would be if one of those that go first were where it wants to be.

        Those that have been held for long go first; of two of them, as always.
        """
        now = {update.robot_id: update.at for update in self._team.updates if update.at != NO_CELL}
        before = [update for update in self._before(work, helped=True) if update.robot_id in now]
        if self._base_cell != NO_CELL:
            now[_BASE] = self._base_cell
        head = _BASE if _BASE in now else before[0].robot_id if before else self._robot_id
        wanted = [(u.robot_id, u.wanted) for u in before if u.wanted is not msgspec.UNSET and u.wanted != NO_CELL]
        return [_Placing(now, head), *(_Placing({**now, i: cell}, i) for i, cell in wanted)]

    def _part_of(self, start: int, cells: Mapping[int, int], links: np.ndarray) -> set[int]:
        """Return the ids of all that are connected with one, itself included. Args: cells: of each, by id."""
        found, new = {start}, [start]
        while new:
            row = links[cells[new.pop()]]
            near = [i for i, cell in cells.items() if i not in found and row[cell]]
            found.update(near)
            new += near
        return found

    def _connecting(self, placing: _Placing, links: np.ndarray) -> np.ndarray:
        """Return the cells in which this robot connects all others: those linked to each of their parts, bool."""
        return np.asarray(np.all([self._everywhere, *self._near_parts(placing, links)], axis=0))

    def _keeping(self, at: int, placing: _Placing, links: np.ndarray) -> np.ndarray:
        """Return the cells in which all whom this robot is connected with stay connected with it, bool."""
        kept = [near for near in self._near_parts(placing, links) if near[at]]
        return np.asarray(np.all([self._everywhere, *kept], axis=0))

    def _near_parts(self, placing: _Placing, links: np.ndarray) -> list[np.ndarray]:
        """Return for each part of the others the cells that are linked to it, bool."""
        near: list[np.ndarray] = []
        left = set(placing.cells)
        while left:
            part = self._part_of(min(left), placing.cells, links)
            near.append(np.asarray(links[[placing.cells[i] for i in part]].any(axis=0)))
            left -= part
        return near

    def _is_with_head(self, placing: _Placing, at: int) -> bool:
        return placing.head in self._part_of(self._robot_id, {**placing.cells, self._robot_id: at}, self._sure)

    def _cell_towards(self, position: Vector, target: Vector, paths: _core.control.CellPaths) -> int:
        """Return the cell one step ahead on the straight line to a target; NO_CELL if there is none."""
        share = min(1.0, _STEP_M / max(math.dist(position, target), 1e-9))
        (x_m, y_m), (to_x_m, to_y_m) = position, target
        return paths.start_of((x_m + share * (to_x_m - x_m), y_m + share * (to_y_m - y_m)))


def _step_on(way: CellWay, allowed: np.ndarray) -> _Step:
    """Return the step on a way of two cells or more; the robot is held if the next cell is not allowed."""
    cells, ahead = way
    if not allowed[cells[1]]:
        return _Step(None, cells[1])
    return _Step(ahead, cells[min(_WANTED_CELLS, len(cells) - 1)])
