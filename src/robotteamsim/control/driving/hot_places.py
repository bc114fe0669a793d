"""The hot places that a robot knows, from its thermal camera and its teammates; its paths avoid them."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from robotteamsim import _core
from robotteamsim.scenario.fire import BLOCK_M, REPLAN_NS, Block
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.plan import OCCUPIED, OccupancyGrid
from robotteamsim.scenario.sensors import HeatReading
from robotteamsim.sensing.readings import RobotReading

_NEAR_M = 0.5
"""A robot with free floor within this distance finds paths; otherwise it would drive straight to its goal."""

_FARTHEST_WAY_OUT_M = 10.0
"""How far away a robot looks for a cold place [m]: about the depth of the largest fire that it may be overtaken by."""


class HotPlaces:
    """The blocks that a robot knows to be hot. A place that was hot counts as hot for the rest of the mission."""

    def __init__(self, plan: FloorPlan) -> None:
        self._origin_m = plan.bounds.min
        self.known: set[Block] = set()
        """All known blocks, also those that paths do not avoid yet."""
        self._next_ns = 0
        self.in_sight: tuple[Block, ...] = ()
        """The blocks of the last reading, sorted."""
        self.blocked: tuple[Block, ...] = ()
        """The blocks that paths avoid, sorted."""

    def look(self, robot: RobotReading) -> None:
        """Note the hot places in a robot's reading, if it has a thermal camera."""
        for reading in robot.sensors.values():
            if isinstance(reading, HeatReading):
                self.in_sight = tuple(sorted({self._block_at(place) for place in reading.hot_m}))
                self.known.update(self.in_sight)

    def hear(self, blocks: Iterable[Block]) -> None:
        """Note the hot places that teammates see."""
        self.known.update(blocks)

    def update(self, sim_time_ns: int) -> bool:
        """Let paths avoid all known blocks, unless they have changed shortly before; return whether they change."""
        if len(self.known) == len(self.blocked) or sim_time_ns < self._next_ns:
            return False
        self._next_ns = sim_time_ns + REPLAN_NS
        self.blocked = tuple(sorted(self.known))
        return True

    def is_hot(self, place: tuple[float, float]) -> bool:
        """Whether a place in `map` [m] is in a known block."""
        return self._block_at(place) in self.known

    def way_out(self, grid: _core.plan.PlanningGrid, position: tuple[float, float]) -> tuple[float, float] | None:
        """Return the nearest free place, in `map` [m], for a robot that heat surrounds; None if it does not.

        Args: grid: free space for the robot, with `blocked` occupied.
        """
        if not self.blocked or grid.nearest_free(position, _NEAR_M) is not None:
            return None
        return grid.nearest_free(position, _FARTHEST_WAY_OUT_M)

    def shelter(self, grid: _core.plan.PlanningGrid, position: tuple[float, float]) -> tuple[float, float] | None:
        """Return the nearest free place, in `map` [m], for a robot that stands in a hot place; None if it does not."""
        return grid.nearest_free(position, _FARTHEST_WAY_OUT_M) if self.is_hot(position) else None

    def _block_at(self, place: tuple[float, float]) -> Block:
        (x, y), (min_x, min_y) = place, self._origin_m
        return math.floor((y - min_y) / BLOCK_M), math.floor((x - min_x) / BLOCK_M)


def with_hot_blocks(grid: OccupancyGrid, blocks: Iterable[Block]) -> np.ndarray:
    """Return the cells of a plan's grid with the blocks occupied; blocks outside the grid are ignored."""
    cells = grid.cells.copy()
    per_block = BLOCK_M / grid.resolution_m
    for row, column in blocks:
        rows = slice(round(row * per_block), round((row + 1) * per_block))
        cells[rows, round(column * per_block) : round((column + 1) * per_block)] = OCCUPIED
    return cells
