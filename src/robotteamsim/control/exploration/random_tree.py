"""Frontiers by a rapidly exploring random tree, instead of by a look at every cell."""

from __future__ import annotations

import math

import numpy as np

from robotteamsim.scenario.plan import FREE, UNKNOWN, OccupancyGrid
from robotteamsim.swarm import Vector

_BRANCHES = 200
"""That are tried at each look."""

_LONGEST_M = 2.0
"""A branch is at most so long: eta of [umari2017]."""


class RandomTree:
    """A tree of straight branches over the known floor. A branch that leaves it has found a frontier [umari2017].

    Tree and frontiers are kept, as those of the global detector of the source.
    """

    def __init__(self, root: Vector, rng: np.random.Generator) -> None:
        self._nodes_m = np.array([root])
        self._rng = rng
        self._frontiers: dict[tuple[int, int], None] = {}
        """Cells (row, column), in the order in which they were found."""

    def grow(self, grid: OccupancyGrid) -> np.ndarray:
        """Try some branches; return the frontiers found so far that still are some, as (row, column), shape (n, 2)."""
        low_m, size_m = np.array(grid.origin_m), np.array(grid.cells.shape[::-1]) * grid.resolution_m
        for target in low_m + size_m * self._rng.random((_BRANCHES, 2)):
            self._branch(grid, target)
        unknown = np.pad(grid.cells == UNKNOWN, 1)
        self._frontiers = {
            (row, column): None
            for row, column in self._frontiers
            if grid.cells[row, column] == FREE and unknown[row : row + 3, column : column + 3].any()
        }
        return np.array(list(self._frontiers), dtype=int).reshape(-1, 2)

    def _branch(self, grid: OccupancyGrid, target: np.ndarray) -> None:
        """Try a branch from the nearest node towards a point."""
        away_m = np.hypot(*(self._nodes_m - target).T)
        nearest = int(np.argmin(away_m))
        start = self._nodes_m[nearest]
        end = start + min(_LONGEST_M / max(away_m[nearest], grid.resolution_m), 1.0) * (target - start)
        count = 1 + math.ceil(2.0 * math.dist(start, end) / grid.resolution_m)
        columns, rows = ((np.linspace(start, end, count) - grid.origin_m) / grid.resolution_m).astype(int).T
        crossed = grid.cells[rows, columns]
        begin = int(np.argmax(crossed != UNKNOWN))  # no beam crosses the floor under a robot that has not moved yet
        stop = begin + int(np.argmax(crossed[begin:] != FREE))
        if crossed[stop] == FREE:
            self._nodes_m = np.vstack((self._nodes_m, end))
        elif crossed[stop] == UNKNOWN and stop > begin:
            self._frontiers[int(rows[stop - 1]), int(columns[stop - 1])] = None
