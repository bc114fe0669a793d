"""The cells of a fire on several levels: which level each is on, and which exchange air through openings in floors."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import shapely

from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.levels import Opening, level_at, point_below
from robotteamsim.scenario.plan import Grid


class OpeningCell(NamedTuple):
    """A cell over which a floor is open, and the cell below it.

    above, below: row * cols + column.
    share:        of the cell that is open.
    area_m2:      of the whole opening.
    rise_m:       from floor to floor.
    """

    above: int
    below: int
    share: float
    area_m2: float
    rise_m: float


def levels_of_cells(plan: FloorPlan, centres_m: np.ndarray) -> np.ndarray:
    """Return the index of the level on which each centre lies, shape (rows, cols); -1 beside all levels.

    Args: centres_m: shape (rows, cols, 2).
    """
    found = np.full(centres_m.shape[:-1], -1)
    for index, level in enumerate(plan.levels):
        low_m, high_m = level.bounds.min, level.bounds.max
        found[((centres_m >= low_m) & (centres_m <= high_m)).all(axis=-1)] = index
    return found


def opening_cells(plan: FloorPlan, grid: Grid, in_solid: np.ndarray) -> tuple[OpeningCell, ...]:
    """Return the cells of all openings over a level, but those with a centre in a wall.

    Args: in_solid: whether the centre of each cell is in a wall or block, shape (rows, cols).
    """
    return tuple(cell for opening in plan.openings for cell in _cells_of(plan, opening, grid, in_solid))


def _cells_of(plan: FloorPlan, opening: Opening, grid: Grid, in_solid: np.ndarray) -> list[OpeningCell]:
    level = level_at(plan.levels, opening.polygon[0])
    assert level is not None
    polygon, found = shapely.Polygon(opening.polygon), []
    rows, cols = in_solid.shape
    min_x, min_y, max_x, max_y = polygon.bounds
    (first_row, first_col), (last_row, last_col) = grid.cell_at(min_x, min_y), grid.cell_at(max_x, max_y)
    for row in range(max(first_row, 0), min(last_row, rows - 1) + 1):
        for col in range(max(first_col, 0), min(last_col, cols - 1) + 1):
            x, y = (start + index * grid.resolution_m for start, index in zip(grid.origin_m, (col, row), strict=True))
            part = polygon.intersection(shapely.box(x, y, x + grid.resolution_m, y + grid.resolution_m))
            if part.area == 0.0 or in_solid[row, col]:
                continue
            below = point_below(plan.levels, level, (part.centroid.x, part.centroid.y))
            if below is None:
                continue
            row_below, col_below = grid.cell_at(*below[1])
            if not (0 <= row_below < rows and 0 <= col_below < cols) or in_solid[row_below, col_below]:
                continue
            share, rise_m = part.area / grid.resolution_m**2, level.elevation_m - below[0].elevation_m
            cells = row * cols + col, row_below * cols + col_below
            found.append(OpeningCell(*cells, share, polygon.area, rise_m))
    return found
