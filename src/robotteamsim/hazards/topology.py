"""The cells of a fire: which neighbours are linked, where doors are between them, and what burns in each."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely

from robotteamsim.errors import PlacementError
from robotteamsim.hazards.between_levels import OpeningCell, levels_of_cells, opening_cells
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.fire import MAX_CELLS, Fire, Fuel
from robotteamsim.scenario.floor_plan import Door, FloorPlan
from robotteamsim.scenario.plan import Grid, Solid, door_corners, footprints, grid_shape, solids

Link = tuple[int, bool]
"""Index of a cell (row * cols + column), and whether the link is to its eastern neighbour, not its northern one."""

_MOST_SHARE = 2.0
"""Largest share of the air of a link through a doorway; a leaf of this width in cells crosses two links."""

_LEAF_M = 0.5
"""Length of the open doorway with which `soot.door_leakage` compares the leaf of a closed door."""


@dataclass(frozen=True, slots=True)
class Doorway:
    """A doorway as air sees it on the grid.

    width_m:    of the leaf.
    num_links:  number of links that the leaf crosses, at least 1.
    open_share: of the air of a link that passes each of them when the door is open: all links together are as wide as
                the leaf, so the flow does not depend on the size of the cells.
    """

    width_m: float
    num_links: int
    open_share: float

    def closed_share(self, leakage: float) -> float:
        """Return the share that passes each link when the door is closed.

        The open doorway and the leaf are in series: per height, the leaf conducts leakage * D * width / 0.5 m.
        """
        if leakage == 0.0:
            return 0.0
        leaf = (1.0 / leakage - 1.0) * self.num_links * _LEAF_M / self.width_m
        return 1.0 / (1.0 / self.open_share + leaf)


@dataclass(frozen=True, slots=True, eq=False)
class Topology(Grid):
    """The cells over a plan and the links between them.

    east, north: bool, shape (rows, cols): whether no wall is between a cell and its eastern or northern neighbour.
    in_solid:    bool, shape (rows, cols): whether the centre of a cell is in a wall or block.
    crossings:   of doors: the door's index in the plan, the cell's (row * cols + column), and whether the leaf is
                 between it and its eastern neighbour, not its northern one.
    doorways:    of the doors of the plan, in its order.
    openings:    the cells that exchange air through openings in floors.
    """

    east: np.ndarray
    north: np.ndarray
    in_solid: np.ndarray
    crossings: tuple[tuple[int, int, bool], ...]
    doorways: tuple[Doorway, ...]
    openings: tuple[OpeningCell, ...]

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
    still = shapely.STRtree(footprints(solids(plan.model_copy(update={"doors": ()}))))
    east, north = np.ones((rows, cols), dtype=bool), np.ones((rows, cols), dtype=bool)
    east[:, -1], north[-1] = False, False
    lines = _lines(centres, east=True), _lines(centres, east=False)
    for links, along in zip((east[:, :-1], north[:-1]), lines, strict=True):
        links[np.unravel_index(still.query(along, predicate="intersects")[0], links.shape)] = False
    if plan.levels:
        level_of = levels_of_cells(plan, centres)
        east[:, :-1] &= level_of[:, :-1] == level_of[:, 1:]
        north[:-1] &= level_of[:-1] == level_of[1:]
    in_solid = np.zeros((rows, cols), dtype=bool)
    in_solid.flat[still.query(shapely.points(centres).ravel(), predicate="intersects")[0]] = True
    crossings = []
    doorways = []
    for index, (door, crossed) in enumerate(zip(plan.doors, _links_through(plan, lines, cols), strict=True)):
        free = [(cell, is_east) for cell, is_east in crossed if (east if is_east else north).flat[cell]]
        if not free:
            cell, is_east = _nearest_link(door, grid, (rows, cols))
            (east if is_east else north).flat[cell] = True
            free = [(cell, is_east)]
        crossings += [(index, cell, is_east) for cell, is_east in free]
        doorways.append(_doorway(door, free, cell_m))
    openings = opening_cells(plan, grid, in_solid)
    return Topology(grid.origin_m, cell_m, east, north, in_solid, tuple(crossings), tuple(doorways), openings)


def _lines(centres: np.ndarray, east: bool) -> np.ndarray:
    """Return the lines between neighbouring centres, row by row."""
    before, after = (centres[:, :-1], centres[:, 1:]) if east else (centres[:-1], centres[1:])
    lines: np.ndarray = shapely.linestrings(np.stack([before, after], axis=-2).reshape(-1, 2, 2))
    return lines


def _links_through(plan: FloorPlan, lines: tuple[np.ndarray, np.ndarray], cols: int) -> list[list[Link]]:
    """Return, for each door, the links that the leaf of the closed door crosses."""
    found: list[list[Link]] = [[] for _ in plan.doors]
    if not plan.doors:
        return found
    leaves = [Solid(door.name, "door", door_corners(door), door).polygon for door in plan.doors]
    for along, is_east in zip(lines, (True, False), strict=True):
        door_ids, line_ids = shapely.STRtree(along).query(leaves, predicate="intersects")
        ends = shapely.get_coordinates(along[line_ids]).reshape(-1, 2, 2)
        # A centre may be in the leaf: the air must cross one link, not two in series.
        crosses = np.array([_sides_differ(plan.doors[i], *pair) for i, pair in zip(door_ids, ends, strict=True)], bool)
        for door, line in zip(door_ids[crosses].tolist(), line_ids[crosses].tolist(), strict=True):
            row, col = divmod(line, cols - 1 if is_east else cols)
            found[door].append((row * cols + col, is_east))
    return found


def _sides_differ(door: Door, first: np.ndarray, second: np.ndarray) -> bool:
    """Return whether two points are on different sides of the middle of a door's leaf."""
    (x, y), (x_end, y_end) = door.start, door.end
    left = [(x_end - x) * (point[1] - y) - (y_end - y) * (point[0] - x) >= 0.0 for point in (first, second)]
    return bool(left[0] != left[1])


def _nearest_link(door: Door, grid: Grid, shape: tuple[int, int]) -> Link:
    """Return the link through a doorway that is narrower than the cells and between their centres."""
    rows, cols = shape
    is_east = abs(door.end[1] - door.start[1]) >= abs(door.end[0] - door.start[0])
    back_m = 0.5 * grid.resolution_m
    x, y = (door.start[0] + door.end[0]) / 2, (door.start[1] + door.end[1]) / 2
    row, col = grid.cell_at(x - back_m, y) if is_east else grid.cell_at(x, y - back_m)
    row = max(min(row, rows - (1 if is_east else 2)), 0)
    col = max(min(col, cols - (2 if is_east else 1)), 0)
    return row * cols + col, is_east


def _doorway(door: Door, links: list[Link], cell_m: float) -> Doorway:
    """Return how the air passes a doorway.

    A gradient of concentration along the door's normal n drives |n_x| of it through each eastern link.
    """
    width_m = math.dist(door.start, door.end)
    normal_x, normal_y = abs(door.end[1] - door.start[1]) / width_m, abs(door.end[0] - door.start[0]) / width_m
    links_m = cell_m * sum(normal_x if is_east else normal_y for _, is_east in links)
    return Doorway(width_m, len(links), min(width_m / links_m, _MOST_SHARE))


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
