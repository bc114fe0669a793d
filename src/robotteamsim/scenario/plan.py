"""The geometry of a floor plan: outlines of its elements and its occupancy grid."""

import dataclasses
import functools
import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, TypeVar

import numpy as np
import shapely

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.floor_plan import Block, Bounds, Door, FloorPlan, Wall
from robotteamsim.scenario.levels import Level

Corners = tuple[tuple[float, float], ...]
_Element = TypeVar("_Element")

FREE = 0
OCCUPIED = 100
UNKNOWN = -1

MOST_CELLS = 100_000_000
"""Of one map: 1 km x 1 km in cells of 10 cm."""

_RIGHT_ANGLE = 1e-6
"""Largest cosine of an angle that counts as a right one."""

_EDGE_TOLERANCE_CELLS = 1e-6
"""An outline on the border of a cell, up to rounding, does not enter the cell."""


@dataclass(frozen=True, slots=True)
class Solid:
    """The footprint of one element: corners counter-clockwise in the map frame [m], not closed."""

    name: str
    kind: Literal["wall", "block", "pillar", "door"]
    corners: Corners
    element: Wall | Block | Door

    @property
    def polygon(self) -> shapely.Polygon:
        """The footprint as a shapely polygon."""
        return shapely.Polygon(self.corners)


def wall_corners(wall: Wall) -> Corners:
    """Return the four corners of a wall, counter-clockwise from the right side of its start [m]."""
    return strip_corners(wall.start, wall.end, wall.thickness_m)


def door_corners(door: Door) -> Corners:
    """Return the four corners of a closed door's leaf, counter-clockwise from the right side of its hinge [m]."""
    return strip_corners(door.start, door.end, door.thickness_m)


def leaf_corners(door: Door, opening: float) -> Corners:
    """Return the four corners of the leaf of a door that swings or slides [m]; opening: 0 closed .. 1 open."""
    turn_rad, (shift_x, shift_y) = door.leaf_angle_rad * opening, door.leaf_shift_m
    cos, sin = math.cos(turn_rad), math.sin(turn_rad)
    x0, y0 = door.start
    return tuple(
        (
            x0 + shift_x * opening + cos * (x - x0) - sin * (y - y0),
            y0 + shift_y * opening + sin * (x - x0) + cos * (y - y0),
        )
        for x, y in door_corners(door)
    )


def solids(plan: FloorPlan, closed: Mapping[str, bool] | None = None) -> tuple[Solid, ...]:
    """Return everything that a robot can hit: walls, blocks, pillars and leaves of doors, in the plan's order.

    The leaf of a closed door covers its gap; that of an open one is at its open position, or does not exist.

    Args:   closed: door states by name that replace the plan's own.
    Raises: ScenarioError: `closed` names a door that the plan does not have.
    """
    return (*_still_solids(plan.walls, plan.blocks), *_leaves(plan, door_states(plan, closed)))


@functools.lru_cache(maxsize=8)  # the parts of a simulation ask twenty times
def _still_solids(walls: tuple[Wall, ...], blocks: tuple[Block, ...]) -> tuple[Solid, ...]:
    return (
        *(Solid(wall.name, "wall", wall_corners(wall), wall) for wall in walls),
        *(Solid(block.name, block.kind, counter_clockwise(block.polygon), block) for block in blocks),
    )


def _leaves(plan: FloorPlan, states: Mapping[str, bool]) -> Iterator[Solid]:
    for door in plan.doors:
        if states[door.name]:
            yield Solid(door.name, "door", door_corners(door), door)
        elif door.motion != "instant":
            yield Solid(door.name, "door", leaf_corners(door, 1.0), door)


def bay_lines(plan: FloorPlan) -> tuple[tuple[Point, Point], ...]:
    """Return the painted lines between parking bays as segments [m]; the front and back of a row have none."""
    lines = []
    for row in plan.bays:
        start, end = np.array(row.start), np.array(row.end)
        along = end - start
        left = np.array([-along[1], along[0]]) / math.hypot(*along) * row.depth_m
        for i in range(row.count + 1):
            foot = start + along * (i / row.count)
            lines.append((tuple(foot.tolist()), tuple((foot + left).tolist())))
    return tuple(lines)


def painted_lines(plan: FloorPlan) -> tuple[tuple[Point, Point], ...]:
    """Return the lines on the floor as segments [m]: `bay_lines`, and rings around the stops of passages."""
    lines = list(bay_lines(plan))
    for passage in plan.passages:
        for stop in passage.stops:
            ring = shapely.Point(stop).buffer(passage.radius_m).exterior.coords
            lines += itertools.pairwise(ring)
    return tuple(lines)


def floors(plan: FloorPlan) -> tuple[Bounds, ...]:
    """Return the rectangles of floor: the levels, or the whole plan."""
    return tuple(level.bounds for level in plan.levels) or (plan.bounds,)


def plan_of_level(plan: FloorPlan, level: Level) -> FloorPlan:
    """Return the part of a plan that is on a level, with the same coordinates."""

    def on_level(elements: Sequence[_Element], place: Callable[[_Element], Point]) -> tuple[_Element, ...]:
        return tuple(one for one in elements if level.bounds.contains(place(one)))

    passages = [
        passage.model_copy(update={"stops": on_level(passage.stops, lambda stop: stop)}) for passage in plan.passages
    ]
    return plan.model_copy(
        update={
            "bounds": level.bounds,
            "walls": on_level(plan.walls, lambda wall: wall.start),
            "blocks": on_level(plan.blocks, lambda block: block.polygon[0]),
            "doors": on_level(plan.doors, lambda door: door.start),
            "bays": on_level(plan.bays, lambda row: row.start),
            "levels": (level,),
            "openings": on_level(plan.openings, lambda opening: opening.polygon[0]),
            "passages": tuple(passage for passage in passages if passage.stops),
        }
    )


def level_marks(plan: FloorPlan) -> tuple[tuple[str, Point], ...]:
    """Return the names of levels as they are written on the floor, and where [m]."""
    return tuple((f"{level.name} at {level.elevation_m:g} m", level.bounds.min) for level in plan.levels)


def door_states(plan: FloorPlan, closed: Mapping[str, bool] | None = None) -> dict[str, bool]:
    """Return whether each door is closed, by name, in the plan's order; `closed` replaces the plan's own states."""
    states = {door.name: door.closed for door in plan.doors}
    for name, state in (closed or {}).items():
        if name not in states:
            raise ScenarioError(f"{plan.name}: unknown door '{name}'; known: {', '.join(states) or 'none'}")
        states[name] = state
    return states


def obstacles(plan: FloorPlan, closed: Mapping[str, bool] | None = None) -> shapely.Geometry:
    """Return the union of all solids as one shapely geometry, prepared for many queries [m]."""
    return _union(tuple(solid.corners for solid in solids(plan, closed)))


@functools.lru_cache(maxsize=8)  # several checks of one scenario need it
def _union(outlines: tuple[Corners, ...]) -> shapely.Geometry:
    union = shapely.union_all(_polygons(outlines))
    shapely.prepare(union)
    return union


def footprints(of: Sequence[Solid]) -> np.ndarray:
    """Return the footprints of solids as shapely polygons, shape (n,) of objects; much faster than one by one."""
    return _polygons([solid.corners for solid in of])


def _polygons(outlines: Sequence[Corners]) -> np.ndarray:
    points = np.array([corner for corners in outlines for corner in (*corners, corners[0])]).reshape(-1, 2)
    rings = np.repeat(np.arange(len(outlines)), [len(corners) + 1 for corners in outlines])
    return np.asarray(shapely.polygons(shapely.linearrings(points, indices=rings)), dtype=object)


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """Square cells over the floor; origin_m: lower left corner of cell (0, 0) in the map frame [m]."""

    origin_m: tuple[float, float]
    resolution_m: float

    def cell_at(self, x_m: float, y_m: float) -> tuple[int, int]:
        """Return (row, column) of the cell that contains a point; outside the grid if the point is."""
        return (
            math.floor((y_m - self.origin_m[1]) / self.resolution_m),
            math.floor((x_m - self.origin_m[0]) / self.resolution_m),
        )

    def cell_center(self, row: int, column: int) -> tuple[float, float]:
        """Return the centre (x, y) of a cell in the map frame [m]."""
        return (
            self.origin_m[0] + (column + 0.5) * self.resolution_m,
            self.origin_m[1] + (row + 0.5) * self.resolution_m,
        )


@dataclass(frozen=True, slots=True, eq=False)
class OccupancyGrid(Grid):
    """Which cells of a floor plan are free.

    cells: int8, shape (rows, cols), row 0 at the lowest y: 0 free, 100 occupied, -1 unknown.
    """

    cells: np.ndarray


def grid_shape(plan: FloorPlan, resolution_m: float) -> tuple[int, int]:
    """Return (rows, columns) of the cells over a plan's bounds; the last ones may reach beyond.

    Raises: ValueError: the resolution is not finite and above 0, or far too small.
    """
    return shape_over(plan.bounds, resolution_m)


def shape_over(bounds: Bounds, resolution_m: float) -> tuple[int, int]:
    """Return `grid_shape` of a plan with these bounds. Raises: ValueError: as there."""
    if not 0.0 < resolution_m < math.inf:
        raise ValueError(f"resolution_m must be finite and > 0, got {resolution_m}")
    (min_x, min_y), (max_x, max_y) = bounds.min, bounds.max
    if not max(max_x - min_x, max_y - min_y) / resolution_m < 2.0**31:
        raise ValueError(f"resolution_m {resolution_m:g} is too small for a plan of {bounds}")
    columns = math.ceil((max_x - min_x) / resolution_m - _EDGE_TOLERANCE_CELLS)
    rows = math.ceil((max_y - min_y) / resolution_m - _EDGE_TOLERANCE_CELLS)
    return rows, columns


def too_many_cells(plan: FloorPlan, resolution_m: float) -> str | None:
    """Return why a map of a plan would be too large: its size, and what is expected; None if it is not."""
    rows, columns = grid_shape(plan, resolution_m)
    if rows * columns <= MOST_CELLS:
        return None
    least_mm = math.ceil(1000.0 * resolution_m * math.sqrt(rows * columns / MOST_CELLS))
    while math.prod(grid_shape(plan, least_mm / 1000.0)) > MOST_CELLS:
        least_mm += 1
    size = f"{resolution_m:g} makes a map of {columns:,} x {rows:,} cells, more than {MOST_CELLS // 10**6} million"
    return f"{size}; expected at least {least_mm / 1000.0:g}"


def occupancy_grid(plan: FloorPlan, resolution_m: float, closed: Mapping[str, bool] | None = None) -> OccupancyGrid:
    """Return the occupancy grid of a plan over its bounds.

    Conservative: a cell is occupied when a solid covers any part of its area; a shared border does not count, so
    axis-aligned walls on cell borders are exact. The leaves of doors are solid, also in their open position, and so is
    everything beside the levels of a plan that has some.

    Args:   resolution_m: edge of a cell; the last row and column may reach beyond the bounds.
            closed: door states by name that replace the plan's own.
    Raises: ValueError: the resolution is not finite and above 0, or makes too many cells. ScenarioError: `closed` names
            no door of the plan.
    """
    rows, columns = grid_shape(plan, resolution_m)
    if why := too_many_cells(plan, resolution_m):
        raise ValueError(f"resolution_m {why}")
    min_x, min_y = plan.bounds.min
    cells = np.zeros((rows, columns), dtype=np.int8)
    outlines = [solid.corners for solid in solids(plan, closed)]
    if outlines:
        starts = np.array([corner for corners in outlines for corner in corners])
        ends = np.array([corner for corners in outlines for corner in (*corners[1:], corners[0])])
        origin = np.array([min_x, min_y])
        starts, ends = (starts - origin) / resolution_m, (ends - origin) / resolution_m
        covered = _centres_inside(starts, ends, rows, columns) | _cells_crossed(starts, ends, rows, columns)
        cells[covered] = OCCUPIED
    if plan.levels:
        cells[beside_levels(plan, resolution_m, rows, columns)] = OCCUPIED
    return OccupancyGrid((min_x, min_y), resolution_m, cells)


def level_grid(plan: FloorPlan, level: Level, resolution_m: float) -> OccupancyGrid:
    """Return the `occupancy_grid` of a level; its coordinates are those from the level's origin."""
    grid = occupancy_grid(plan_of_level(plan, level), resolution_m)
    (x_m, y_m), (origin_x, origin_y) = grid.origin_m, level.origin
    return dataclasses.replace(grid, origin_m=(x_m - origin_x, y_m - origin_y))


def beside_levels(plan: FloorPlan, resolution_m: float, rows: int, columns: int) -> np.ndarray:
    """Return the cells over a plan's bounds whose centre lies on no level, bool, shape (rows, columns)."""
    x_m = plan.bounds.min[0] + (np.arange(columns) + 0.5) * resolution_m
    y_m = plan.bounds.min[1] + (np.arange(rows) + 0.5) * resolution_m
    beside = np.ones((rows, columns), dtype=bool)
    for level in plan.levels:
        (min_x, min_y), (max_x, max_y) = level.bounds.min, level.bounds.max
        beside &= ~np.outer((y_m >= min_y) & (y_m <= max_y), (x_m >= min_x) & (x_m <= max_x))
    return beside


def strip_corners(start: Point, end: Point, width_m: float) -> Corners:
    """Return the corners of a rectangle around a line, counter-clockwise from the right side of its start [m]."""
    (x0, y0), (x1, y1) = start, end
    length_m = math.hypot(x1 - x0, y1 - y0)
    if length_m == 0.0:
        raise ValueError(f"a strip needs two different ends, got {start} twice")
    left_x, left_y = -(y1 - y0) / length_m * width_m / 2.0, (x1 - x0) / length_m * width_m / 2.0
    return (
        (x0 - left_x, y0 - left_y),
        (x1 - left_x, y1 - left_y),
        (x1 + left_x, y1 + left_y),
        (x0 + left_x, y0 + left_y),
    )


def counter_clockwise(polygon: Sequence[tuple[float, float]]) -> Corners:
    """Return the corners of a polygon in counter-clockwise order."""
    corners = tuple((x, y) for x, y in polygon)
    twice_area = sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in zip(corners, (*corners[1:], corners[0]), strict=True))
    return corners if twice_area > 0.0 else corners[::-1]


@dataclass(frozen=True, slots=True)
class Rectangle:
    """A rectangle on the floor: its middle, the direction of its first side, and both sides [m, m, rad]."""

    x: float
    y: float
    yaw: float
    length_m: float
    width_m: float


def rectangle_of(corners: Corners) -> Rectangle | None:
    """Return four corners in order as a rectangle; its first side is from the first corner; None: they are not one."""
    if len(corners) != 4:
        return None
    (x0, y0), (x1, y1), (x2, y2), (x3, y3) = corners
    length_m, width_m = math.hypot(x1 - x0, y1 - y0), math.hypot(x3 - x0, y3 - y0)
    if min(length_m, width_m) <= 0.0:
        return None
    if max(abs(x0 + x2 - x1 - x3), abs(y0 + y2 - y1 - y3)) > _RIGHT_ANGLE * max(length_m, width_m):
        return None
    if abs((x1 - x0) * (x3 - x0) + (y1 - y0) * (y3 - y0)) > _RIGHT_ANGLE * length_m * width_m:
        return None
    return Rectangle(0.5 * (x0 + x2), 0.5 * (y0 + y2), math.atan2(y1 - y0, x1 - x0), length_m, width_m)


def _spans(first: np.ndarray, last: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return (index, value) of every integer in first[index]..last[index]; empty where last < first."""
    counts = np.maximum(last - first + 1, 0)
    index = np.repeat(np.arange(len(first)), counts)
    offset = np.arange(len(index)) - np.repeat(np.cumsum(counts) - counts, counts)
    return index, first[index] + offset


def _centres_inside(starts: np.ndarray, ends: np.ndarray, rows: int, columns: int) -> np.ndarray:
    """Return the cells whose centre lies in a counter-clockwise outline: the winding number, row by row.

    Args: starts, ends: float64, shape (edges, 2): edges in cells from the grid's origin.
    """
    low, high = np.minimum(starts[:, 1], ends[:, 1]), np.maximum(starts[:, 1], ends[:, 1])
    first, last = np.ceil(low - 0.5).astype(int), np.ceil(high - 0.5).astype(int) - 1
    edge, row = _spans(np.maximum(first, 0), np.minimum(last, rows - 1))
    (x0, y0), (x1, y1) = starts[edge].T, ends[edge].T
    x = x0 + (row + 0.5 - y0) * (x1 - x0) / (y1 - y0)
    column = np.clip(np.ceil(x - 0.5), 0, columns).astype(int)
    change = np.zeros((rows, columns + 1), dtype=np.int32)
    np.add.at(change, (row, column), np.where(y1 < y0, 1, -1))
    return np.asarray(np.cumsum(change, axis=1, out=change)[:, :columns] > 0)


def _cells_crossed(starts: np.ndarray, ends: np.ndarray, rows: int, columns: int) -> np.ndarray:
    """Return the cells whose interior an edge crosses; arguments as in `_centres_inside`."""
    tolerance = _EDGE_TOLERANCE_CELLS
    low, high = np.minimum(starts[:, 1], ends[:, 1]), np.maximum(starts[:, 1], ends[:, 1])
    first, last = np.floor(low + tolerance).astype(int), np.ceil(high - tolerance).astype(int) - 1
    edge, row = _spans(np.maximum(first, 0), np.minimum(last, rows - 1))
    (x0, y0), (x1, y1) = starts[edge].T, ends[edge].T
    level = y1 == y0
    slope = (x1 - x0) / np.where(level, 1.0, y1 - y0)
    x_low = np.where(level, x0, x0 + (np.clip(row, low[edge], high[edge]) - y0) * slope)
    x_high = np.where(level, x1, x0 + (np.clip(row + 1, low[edge], high[edge]) - y0) * slope)
    left, right = np.minimum(x_low, x_high), np.maximum(x_low, x_high)
    first_column = np.maximum(np.floor(left + tolerance).astype(int), 0)
    last_column = np.minimum(np.ceil(right - tolerance).astype(int) - 1, columns - 1)
    change = np.zeros((rows, columns + 1), dtype=np.int32)
    runs = last_column >= first_column
    np.add.at(change, (row[runs], first_column[runs]), 1)
    np.add.at(change, (row[runs], last_column[runs] + 1), -1)
    return np.asarray(np.cumsum(change, axis=1, out=change)[:, :columns] > 0)
