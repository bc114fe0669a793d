"""The building as a robot has found it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotteamsim.interface.survey_news import bounds
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.building import Doors, SharedResults
from robotteamsim.scenario.controllers.mapping import SHARED_CELL_M
from robotteamsim.scenario.floor_plan import Block, FloorPlan
from robotteamsim.scenario.levels import Portal, Traveller
from robotteamsim.scenario.plan import OCCUPIED, UNKNOWN, OccupancyGrid, grid_shape

CELL_M = SHARED_CELL_M
"""Edge of a cell: as in the maps of known buildings."""

Part = tuple[slice, slice] | tuple[np.ndarray, np.ndarray]
"""Some cells, as an index: a rectangle, or the rows and columns of each."""

_THICKEST = 8
"""Cells: Table 3 ends with walls of 0.8 m."""


def without_walls(plan: FloorPlan) -> FloorPlan:
    """Return what a robot knows of a building that it does not know: its name and its bounds."""
    return FloorPlan(name=plan.name, bounds=plan.bounds)


class FoundMap(SharedResults):
    """What a robot and its team have seen: a `MapSource`."""

    def __init__(self, known: FloorPlan) -> None:
        """Args: known: what the robot knows from the start, see `without_walls`."""
        super().__init__()
        self.version = 0
        self.cells = np.full(grid_shape(known, CELL_M), UNKNOWN, dtype=np.int8)
        """FREE, OCCUPIED or UNKNOWN, int8, shape (rows, cols), row 0 at the lowest y; not changed but by `show`."""
        self.known = known

    @property
    def origin_m(self) -> Point:
        """Lower left corner of cell (0, 0), in `map` [m]."""
        return self.known.bounds.min

    @property
    def known_part(self) -> OccupancyGrid:
        """A copy of the cells around all that are known; of one cell that is UNKNOWN, if none are."""
        rows, columns = bounds(self.cells != UNKNOWN)
        (x0, y0), part = self.origin_m, self.cells[rows, columns]
        part = part.copy() if part.size else np.full((1, 1), UNKNOWN, dtype=np.int8)
        return OccupancyGrid((x0 + columns.start * CELL_M, y0 + rows.start * CELL_M), CELL_M, part)

    def show(self, parts: Sequence[tuple[Part, np.ndarray]]) -> bool:
        """Replace some cells; return whether some differ, which makes a new version."""
        if all(np.array_equal(self.cells[part], new) for part, new in parts):
            return False
        self.cells = self.cells.copy()  # who has the cells of an older version keeps them
        for part, new in parts:
            self.cells[part] = new
        self.version += 1
        self.forget()
        return True

    @property
    def plan(self) -> FloorPlan:
        """The walls found so far."""
        return self.shared(_plan)

    def grid(self, resolution_m: float, doors: Doors = ()) -> OccupancyGrid:
        """Return the cells. Raises: ValueError: the resolution is another one."""
        if resolution_m != CELL_M:
            raise ValueError(f"resolution_m: {resolution_m:g}; expected {CELL_M:g} for a map that was found")
        return self.shared(_grid)

    def portals(self, by: Traveller) -> list[Portal]:
        """Return none: the building has one level."""
        return []


def _plan(found: FoundMap) -> FloorPlan:
    return found.known.model_copy(update={"blocks": walls_of(found.cells, found.origin_m)})


def _grid(found: FoundMap) -> OccupancyGrid:
    return OccupancyGrid(found.origin_m, CELL_M, found.cells)


def walls_of(cells: np.ndarray, origin_m: Point) -> tuple[Block, ...]:
    """Return walls that cover the occupied cells, each once: rows and columns of cells.

    What nobody can see between two sides of a wall, at most _THICKEST cells, is part of it. The thickness, which
    determines the loss class, is the shorter extent of a cell's row and column.

    Args: cells: int8, shape (rows, cols), row 0 at the lowest y.
    """
    solid = (cells == OCCUPIED) | _inside(cells) | _inside(cells.T).T
    along_x, along_y = _run_lengths(solid), _run_lengths(solid.T).T
    thickness = np.minimum(along_x, along_y)
    walls = []
    for axis, in_lines, thick in (
        ("x", solid & (along_x >= along_y), thickness),
        ("y", (solid & (along_x < along_y)).T, thickness.T),
    ):
        for line, first, last in _runs(in_lines):
            corners = [(first, line), (last + 1, line), (last + 1, line + 1), (first, line + 1)]
            points = corners if axis == "x" else [(row, column) for column, row in reversed(corners)]
            # Thousands of walls, which need no check.
            walls.append(
                Block.model_construct(
                    name=f"found_{axis}_{line}_{first}",
                    kind="block",
                    polygon=tuple(
                        (round(x * CELL_M + origin_m[0], 6), round(y * CELL_M + origin_m[1], 6)) for x, y in points
                    ),
                    thickness_m=float(np.median(thick[line, first : last + 1])) * CELL_M,
                    height_m=2.6,
                    material=None,
                )
            )
    return tuple(walls)


def _inside(cells: np.ndarray) -> np.ndarray:
    """Return the unknown cells between two occupied ones of a row that are not too far apart, bool."""
    inside = np.zeros(cells.shape, dtype=bool)
    for line, first, last in _runs(cells == UNKNOWN):
        beside = cells[line, first - 1 : first], cells[line, last + 1 : last + 2]
        if last - first < _THICKEST - 2 and all(side.size and side[0] == OCCUPIED for side in beside):
            inside[line, first : last + 1] = True
    return inside


def _runs(cells: np.ndarray) -> list[tuple[int, int, int]]:
    """Return the row, first and last column of each run of true cells."""
    edges = np.diff(np.pad(cells, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    lines, firsts = np.nonzero(edges == 1)
    _, ends = np.nonzero(edges == -1)
    return list(zip(lines.tolist(), firsts.tolist(), (ends - 1).tolist(), strict=True))


def _run_lengths(cells: np.ndarray) -> np.ndarray:
    """Return for each true cell the length of its run along the row, else 0; int64, of the same shape."""
    lengths = np.zeros(cells.shape, dtype=np.int64)
    for line, first, last in _runs(cells):
        lengths[line, first : last + 1] = last - first + 1
    return lengths
