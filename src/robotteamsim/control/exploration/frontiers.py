"""The frontiers of a map, and what may be seen from them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robotteamsim import _core
from robotteamsim.scenario.plan import FREE, UNKNOWN, OccupancyGrid
from robotteamsim.swarm import Vector

_BLOCK_M = 1.0
"""Of frontier cells in one block of this size, one is a candidate."""

_RAYS = 48
"""Around a candidate, along which floor is counted that may be seen from there."""

_LEAST_DISCOUNT = 0.05
"""If teammates go to all frontiers, the best of them is still chosen."""


@dataclass(frozen=True, eq=False)
class Goals:
    """Places to which a robot may go.

    places_m: centres of free cells, shape (n, 2) [m].
    paths_m:  lengths of the paths there, shape (n,) [m].
    gains_m2: unknown floor that may be seen from each, shape (n,).
    """

    places_m: np.ndarray
    paths_m: np.ndarray
    gains_m2: np.ndarray

    def __len__(self) -> int:
        return len(self.paths_m)

    def where(self, is_kept: np.ndarray) -> Goals:
        """Return some of them. Args: is_kept: bool, shape (n,)."""
        return Goals(self.places_m[is_kept], self.paths_m[is_kept], self.gains_m2[is_kept])

    def joined_with(self, other: Goals) -> Goals:
        """Return these, then others."""
        return Goals(
            np.concatenate((self.places_m, other.places_m)),
            np.concatenate((self.paths_m, other.paths_m)),
            np.concatenate((self.gains_m2, other.gains_m2)),
        )


def frontier_cells(grid: OccupancyGrid) -> np.ndarray:
    """Return all free cells with an unknown one beside, above or below them [yamauchi1997].

    Returns: (row, column) of each, shape (n, 2).
    """
    unknown = grid.cells == UNKNOWN
    beside = np.zeros_like(unknown)
    beside[1:] |= unknown[:-1]
    beside[:-1] |= unknown[1:]
    beside[:, 1:] |= unknown[:, :-1]
    beside[:, :-1] |= unknown[:, 1:]
    # In one dimension, which is much faster than in two.
    found = np.flatnonzero((grid.cells == FREE) & beside)
    return np.stack(np.divmod(found, grid.cells.shape[1]), axis=1)


def frontiers(grid: OccupancyGrid, cells: np.ndarray, lengths_m: np.ndarray, range_m: float) -> Goals:
    """Return those of the frontier cells that can be reached, the nearest one in each block of _BLOCK_M.

    Args: cells:     (row, column) of each, shape (n, 2).
          lengths_m: of the paths to all cells of the grid, inf where there is none.
          range_m:   of the laser.
    """
    rows, columns = cells[np.isfinite(lengths_m[cells[:, 0], cells[:, 1]])].T
    per_block = round(_BLOCK_M / grid.resolution_m)
    blocks = (rows // per_block) * (grid.cells.shape[1] // per_block + 1) + columns // per_block
    lengths = lengths_m[rows, columns]
    # The first of each block in the order of the lengths.
    order = np.lexsort((columns, rows, lengths))
    _, first = np.unique(blocks[order], return_index=True)
    chosen = order[first]
    places_m = (np.stack((columns[chosen], rows[chosen]), axis=1) + 0.5) * grid.resolution_m + grid.origin_m
    return Goals(places_m, lengths[chosen], gains_m2(grid, places_m, range_m))


def gains_m2(grid: OccupancyGrid, places_m: np.ndarray, range_m: float) -> np.ndarray:
    """Return the unknown floor that a laser with a range may see from places, if no unknown cell is a wall.

    Args:    places_m: on the grid, shape (n, 2); rays begin in the middle of their cells.
    Returns: shape (n,).
    """
    angles_rad = [2.0 * math.pi / _RAYS * ray for ray in range(_RAYS)]
    # Not NumPy's, whose last bits depend on the processor: some rays end half way between two cells.
    along = np.array([(math.sin(angle_rad), math.cos(angle_rad)) for angle_rad in angles_rad])
    # Found walls may be one cell thick.
    along_m = np.arange(1, math.floor(range_m / grid.resolution_m) + 1) * grid.resolution_m
    rays = np.rint(along[:, None] * (along_m / grid.resolution_m)[:, None])
    cells = np.floor((places_m - grid.origin_m) / grid.resolution_m)[:, ::-1]
    # Each sample along a ray is a piece of a ring.
    areas_m2: np.ndarray = along_m * grid.resolution_m * (2.0 * math.pi / _RAYS)
    seen_m2 = _core.control.unknown_in_view(grid.cells, cells.astype(np.int32), rays.astype(np.int32), areas_m2)
    return np.asarray(seen_m2)


def discount(places_m: np.ndarray, goals_m: Sequence[Vector], range_m: float) -> np.ndarray:
    """Return by what factor the gain of places shrinks, because teammates go there [burgard2005, Algorithm 1].

    It grows with the distance from a goal, up to 1 from the range of the laser on. At a goal it is small, but not 0.
    """
    factor = np.ones(len(places_m))
    for goal in goals_m:
        factor *= np.clip(np.hypot(*(places_m - goal).T) / range_m, _LEAST_DISCOUNT, 1.0)
    return factor
