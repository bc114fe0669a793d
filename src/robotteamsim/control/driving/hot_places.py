"""The hot places that a robot knows, from its thermal camera and its teammates; its paths avoid them."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from robotteamsim import _core
from robotteamsim.scenario.fire import BLOCK_M, REPLAN_NS, Block, HotBlock
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.plan import OCCUPIED, OccupancyGrid
from robotteamsim.scenario.sensors import HeatReading
from robotteamsim.sensing.readings import RobotReading

_NEAR_M = 0.5
"""A robot with free floor within this distance finds paths; otherwise it would drive straight to its goal."""

_FARTHEST_WAY_OUT_M = 10.0
"""How far away a robot looks for a cold place [m]: about the depth of the largest fire that it may be overtaken by."""


class HotPlaces:
    """The blocks that somebody knows to be too hot for them. What was too hot counts as such until the mission ends.

    Robots avoid `fire.heat.block_c` and more, firefighters `firefighters.block_c` and more.
    """

    def __init__(self, plan: FloorPlan, limit_c: float) -> None:
        """Args: limit_c: from this temperature on, a place is too hot [degC]."""
        self._origin_m, self._limit_c = plan.bounds.min, math.floor(limit_c)  # temperatures are rounded down, too
        self.known: set[Block] = set()
        """All known blocks, also those that paths do not avoid yet."""
        self._next_ns = 0
        self.seen: tuple[HotBlock, ...] = ()
        """All hot blocks of the last reading, sorted, also those that are not too hot."""
        self.in_sight: tuple[Block, ...] = ()
        """The blocks of the last reading, sorted."""
        self.blocked: tuple[Block, ...] = ()
        """The blocks that paths avoid, sorted."""

    def look(self, robot: RobotReading) -> None:
        """Note the hot places in a robot's reading, if it has a thermal camera."""
        for reading in robot.sensors.values() if robot.sensors else ():
            if isinstance(reading, HeatReading):
                hottest: dict[Block, int] = {}
                for place, temperature_c in zip(reading.hot_m, reading.hot_c, strict=True):
                    block = self._block_at(place)
                    hottest[block] = max(hottest.get(block, -(10**6)), math.floor(temperature_c))
                self.seen = tuple((*block, hottest[block]) for block in sorted(hottest))
                self.in_sight = self._too_hot(self.seen)
                self.known.update(self.in_sight)

    def hear(self, blocks: Iterable[Block]) -> None:
        """Note blocks that are too hot for teammates with the same limit."""
        self.known.update(blocks)

    def hear_temperatures(self, blocks: Iterable[HotBlock]) -> None:
        """Note the hot blocks that anybody sees."""
        self.known.update(self._too_hot(blocks))

    def _too_hot(self, blocks: Iterable[HotBlock]) -> tuple[Block, ...]:
        return tuple(
            (row, column) for row, column, temperature_c in blocks if temperature_c >= math.floor(self._limit_c)
        )

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
