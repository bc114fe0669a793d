"""A floor plan as the occupancy image that map_server reads."""

import os
from pathlib import Path

import numpy as np

from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.plan import FREE, OCCUPIED, OccupancyGrid, occupancy_grid
from robotteamsim.scenario.yaml_text import write

RESOLUTION_M = 0.05

_FREE_GREY, _UNKNOWN_GREY, _OCCUPIED_GREY = 254, 205, 0


def export_map(plan: FloorPlan, folder: str | os.PathLike[str], resolution_m: float = RESOLUTION_M) -> None:
    """Write `map.yaml` and `map.pgm` into a folder: free cells white, occupied black, closed doors as walls.

    Raises: OSError: the folder cannot be written.
    """
    grid = occupancy_grid(plan, resolution_m)
    settings = {
        "image": "map.pgm",
        "resolution": resolution_m,
        "origin": [*grid.origin_m, 0.0],
        "negate": 0,
        "occupied_thresh": 0.65,
        "free_thresh": 0.196,
    }
    Path(folder, "map.pgm").write_bytes(pgm(grid))
    Path(folder, "map.yaml").write_text(write(settings), encoding="utf-8")


def pgm(grid: OccupancyGrid) -> bytes:
    """Return an occupancy grid as a binary grey image (PGM, P5), highest y in the first row."""
    grey = np.full(grid.cells.shape, _UNKNOWN_GREY, dtype=np.uint8)
    grey[grid.cells == FREE] = _FREE_GREY
    grey[grid.cells == OCCUPIED] = _OCCUPIED_GREY
    rows, columns = grid.cells.shape
    return b"P5\n%d %d\n255\n" % (columns, rows) + np.flipud(grey).tobytes()
