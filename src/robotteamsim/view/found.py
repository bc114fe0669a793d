"""What robots have found of a building, as layers of a viewer, compared with the building."""

from __future__ import annotations

import numpy as np

from robotteamsim.maps.found_map import CELL_M
from robotteamsim.scenario.building import building_of
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.plan import FREE, OCCUPIED, OccupancyGrid, grid_shape
from robotteamsim.view.layers import LayerMap, merged

FOUND_FREE, FOUND_WALL, WRONG_WALL = 1, 2, 3
"""Values of cells; 0 is unknown. Where cells are merged, the largest one is shown."""

_MOST_CELLS = 300_000
"""60 m x 50 m in cells of 10 cm."""


class FoundLayers:
    """Makes the maps of layers, all over the whole floor."""

    def __init__(self, plan: FloorPlan, most_cells: int = _MOST_CELLS) -> None:
        """Args: most_cells: of a map; finer ones are merged."""
        self._most_cells = most_cells
        self._origin_m, self._shape = plan.bounds.min, grid_shape(plan, CELL_M)
        doors = tuple((door.name, True) for door in plan.doors)
        grids = [building_of(plan).grid(CELL_M, closed) for closed in {(), doors}]
        is_wall = np.any([grid.cells == OCCUPIED for grid in grids], axis=0)
        around = np.lib.stride_tricks.sliding_window_view(np.pad(is_wall, 1), (3, 3))
        self._near_wall = around.any(axis=(2, 3))
        """Within a cell of what is, or with another state of a door would be, a wall."""

    def layer(self, time_s: float, found: OccupancyGrid) -> LayerMap | None:
        """Return what a robot has found; None: its cells are others, as only messages of other programs can have."""
        if not np.isclose(found.resolution_m, CELL_M):
            return None
        values = np.zeros(self._shape, dtype=np.int8)
        left, low = (round((at - zero) / CELL_M) for at, zero in zip(found.origin_m, self._origin_m, strict=True))
        rows, columns = found.cells.shape
        if min(low, left) < 0 or low + rows > self._shape[0] or left + columns > self._shape[1]:
            return None
        part = values[low : low + rows, left : left + columns]
        part[found.cells == FREE] = FOUND_FREE
        part[found.cells == OCCUPIED] = FOUND_WALL
        values[(values == FOUND_WALL) & ~self._near_wall] = WRONG_WALL
        return merged(time_s, self._origin_m, CELL_M, values, self._most_cells)
