"""The cells of a fire: which neighbours are linked, where doors are between them, and what burns in each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely

from robotteamsim.errors import PlacementError
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.fire import MAX_CELLS, Fire, Fuel
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.plan import Grid, Solid, door_corners, grid_shape, solids


@dataclass(frozen=True, slots=True, eq=False)
class Topology(Grid):
    """The cells over a plan and the links between them.

    east, north: bool, shape (rows, cols): whether no wall is between a cell and its eastern or northern neighbour.
    in_solid:    bool, shape (rows, cols): whether the centre of a cell is in a wall or block.
    crossings:   of doors: the door's index in the plan, the cell's (row * cols + column), and whether the leaf is
                 between it and its eastern neighbour, not its northern one.
    """

    east: np.ndarray
    north: np.ndarray
    in_solid: np.ndarray
    crossings: tuple[tuple[int, int, bool], ...]

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        rows, cols = self.east.shape
        return rows, cols

    def contains(self, point: Point) -> bool:
        """Whether a point lies in one of the cells."""
        row, col = self.cell_at(*point)
        return 0 <= row < self.shape[0] and 0 <= col < self.shape[1]

    def room_of(self, point: Point) -> np.ndarray:
        """Return the cells that are linked to that of a point without passing a door, bool, shape (rows, cols)."""
        east, north = self.east.copy(), self.north.copy()
        for _, cell, is_east in self.crossings:
            (east if is_east else north).flat[cell] = False
        found = np.zeros(self.shape, dtype=bool)
        found[self.cell_at(*point)] = True
        count = 0
        while count != (count := int(np.count_nonzero(found))):
            _spread(found, east, north)
        return found


def _spread(found: np.ndarray, east: np.ndarray, north: np.ndarray) -> None:
    """Extend the cells found along rows and columns, over links, in both directions."""
    rows, cols = found.shape
    for col in range(1, cols):
        found[:, col] |= found[:, col - 1] & east[:, col - 1]
    for col in range(cols - 2, -1, -1):
        found[:, col] |= found[:, col + 1] & east[:, col]
    for row in range(1, rows):
        found[row] |= found[row - 1] & north[row - 1]
    for row in range(rows - 2, -1, -1):
        found[row] |= found[row + 1] & north[row]


def topology(plan: FloorPlan, cell_m: float) -> Topology:
    """Return the cells of a plan. Raises: PlacementError: there are too many."""
    rows, cols = grid_shape(plan, cell_m)
    if rows * cols > MAX_CELLS:
        text = f"{cell_m:g} m makes {rows * cols} cells of the plan; expected at most {MAX_CELLS}"
        raise PlacementError(f"fire.cell_m: {text}", "fire.cell_m")
    grid = Grid(plan.bounds.min, cell_m)
    x, y = np.meshgrid(
        plan.bounds.min[0] + cell_m * (np.arange(cols) + 0.5), plan.bounds.min[1] + cell_m * (np.arange(rows) + 0.5)
    )
    centres = np.stack([x, y], axis=-1)
    still = shapely.STRtree([solid.polygon for solid in solids(plan.model_copy(update={"doors": ()}))])
    east, north = np.ones((rows, cols), dtype=bool), np.ones((rows, cols), dtype=bool)
    east[:, -1], north[-1] = False, False
    lines = _lines(centres, east=True), _lines(centres, east=False)
    for links, along in zip((east[:, :-1], north[:-1]), lines, strict=True):
        links[np.unravel_index(still.query(along, predicate="intersects")[0], links.shape)] = False
    in_solid = np.zeros((rows, cols), dtype=bool)
    in_solid.flat[still.query(shapely.points(centres).ravel(), predicate="intersects")[0]] = True
    return Topology(grid.origin_m, cell_m, east, north, in_solid, tuple(_crossings(plan, lines, cols)))


def _lines(centres: np.ndarray, east: bool) -> np.ndarray:
    """Return the lines between neighbouring centres, row by row."""
    before, after = (centres[:, :-1], centres[:, 1:]) if east else (centres[:-1], centres[1:])
    lines: np.ndarray = shapely.linestrings(np.stack([before, after], axis=-2).reshape(-1, 2, 2))
    return lines


def _crossings(plan: FloorPlan, lines: tuple[np.ndarray, np.ndarray], cols: int) -> Iterator[tuple[int, int, bool]]:
    """Yield the door, the cell and the direction of each link that the leaf of a closed door crosses."""
    if not plan.doors:
        return
    leaves = [Solid(door.name, "door", door_corners(door), door).polygon for door in plan.doors]
    for along, is_east in zip(lines, (True, False), strict=True):
        door_ids, line_ids = shapely.STRtree(along).query(leaves, predicate="intersects")
        for door, line in zip(door_ids.tolist(), line_ids.tolist(), strict=True):
            row, col = divmod(line, cols - 1 if is_east else cols)
            yield door, row * cols + col, is_east


def fuel_of_cells(plan: FloorPlan, fire: Fire, cells: Topology) -> np.ndarray:
    """Return the index of the fuel in each cell, int32, shape (rows, cols); -1 where nothing burns.

    Raises: PlacementError: a fuel is outside the plan, or there is no cell for it.
    """
    kinds = np.full(cells.shape, -1, dtype=np.int32)
    for index, fuel in enumerate(fire.fuel):
        where = _cells_of(plan, fuel, f"fire.fuel.{index}", cells) & ~cells.in_solid
        if not where.any():
            key = f"fire.fuel.{index}"
            raise PlacementError(
                f"{key}: '{fuel.name}' covers the centre of no free cell of {cells.resolution_m:g} m", key
            )
        kinds[where] = index
    return kinds


def _cells_of(plan: FloorPlan, fuel: Fuel, key: str, cells: Topology) -> np.ndarray:
    if fuel.room is not None:
        row, col = check_free(plan, f"{key}.room", fuel.room, cells)
        assert cells.in_solid[row, col] == 0
        return cells.room_of(fuel.room)
    if fuel.polygon is not None:
        name, points = "polygon", fuel.polygon
        shape = shapely.Polygon(fuel.polygon)
    else:
        assert fuel.center is not None
        assert fuel.radius_m is not None
        name, points = "center", (fuel.center,)
        shape = shapely.Point(fuel.center).buffer(fuel.radius_m, quad_segs=32)
    for point in points:
        if not plan.bounds.contains(point):
            place = f"[{point[0]:g}, {point[1]:g}]"
            raise PlacementError(f"{key}.{name}: {place} lies outside the plan, {plan.bounds}", f"{key}.{name}")
    rows, cols = cells.shape
    x = cells.origin_m[0] + cells.resolution_m * (np.arange(cols) + 0.5)
    y = cells.origin_m[1] + cells.resolution_m * (np.arange(rows) + 0.5)
    inside: np.ndarray = shapely.contains_xy(shape, *np.meshgrid(x, y))
    return inside


def check_free(plan: FloorPlan, key: str, point: Point, cells: Topology) -> tuple[int, int]:
    """Return row and column of a point's cell. Raises: PlacementError: it is outside the plan or in a wall."""
    place = f"[{point[0]:g}, {point[1]:g}]"
    if not plan.bounds.contains(point) or not cells.contains(point):
        raise PlacementError(f"{key}: {place} lies outside the plan, {plan.bounds}", key)
    still = solids(plan.model_copy(update={"doors": ()}))
    hit = next((solid for solid in still if solid.polygon.intersects(shapely.Point(point))), None)
    if hit is not None:
        raise PlacementError(f"{key}: {place} lies in {hit.kind} '{hit.name}'", key)
    row, col = cells.cell_at(*point)
    if cells.in_solid[row, col]:
        text = f"the centre of its cell of {cells.resolution_m:g} m is in a wall; expected a place farther from walls"
        raise PlacementError(f"{key}: {place}: {text}", key)
    return row, col
