"""What one robot has mapped itself, and where that lies in the map of its team."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from robotteamsim import _core
from robotteamsim.geometry import Pose
from robotteamsim.maps.found_map import CELL_M, FoundMap
from robotteamsim.maps.localiser import turned
from robotteamsim.maps.recent_scans import moved
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.controllers.mapping import Mapping
from robotteamsim.scenario.plan import UNKNOWN
from robotteamsim.scenario.sensors.laser import Laser
from robotteamsim.world.core_parts import core_fan

Rectangle = tuple[slice, slice]
"""Of cells, as an index."""


class OwnMap:
    """A robot's mapper, and its cells in `map`.

    A robot that does not know where it starts takes itself to be in the middle of the building, until `move`.

    cells: int8, of the shape of the found map; not changed but by `take_changes`.
    """

    def __init__(self, laser: Laser, mapping: Mapping, start: Pose, found: FoundMap, *, may_move: bool) -> None:
        """Args: start: as the robot believes.  may_move: whether that may be wrong."""
        self.cells = found.cells.copy()
        self._origin_m, self._factor = found.origin_m, round(CELL_M / mapping.cell_m)
        # The mapper's frame has its origin in cell (0, 0) of the map, so that cells coincide before the first move.
        self._map_T_frame = Pose(*found.origin_m, 0.0)
        self._mapper = mapper_of(laser, mapping, self._map_T_frame.inverse() @ start)
        self._margin = math.ceil(math.hypot(*self.cells.shape)) if may_move else 0
        """Cells around `cells`: wherever the robot started, the building is within."""
        self._framed = np.pad(self.cells, self._margin, constant_values=UNKNOWN) if may_move else self.cells
        """The cells in the mapper's frame, with the margin."""
        self._has_moved = False

    def step(self, odometry: Pose, covariance: Sequence[float], ranges_m: np.ndarray, masked: np.ndarray) -> None:
        """Take what the robot measures in a step. Args: see `_core.maps.Mapper`."""
        self._mapper.step(odometry, covariance, ranges_m, masked)

    def due_at(self, odometry: Pose) -> Pose | None:
        """Return where the robot is by its odometry, in `map`, if the next step with this pose of it is an update."""
        due_at = self._mapper.due_at(odometry)
        return None if due_at is None else self._map_T_frame @ due_at

    def to_frame(self, pose: Pose) -> Pose:
        """Return a pose in `map` as the mapper takes it for that of the odometry."""
        return self._map_T_frame.inverse() @ pose

    @property
    def pose(self) -> Pose:
        """Of the robot, in `map`."""
        return self._map_T_frame @ self._mapper.pose

    @property
    def covariance(self) -> tuple[float, ...]:
        """Of that pose, in `map`, see `Estimate`; of the way since the start alone."""
        return turned(self._mapper.covariance, self._map_T_frame.yaw_rad)

    @property
    def is_lost(self) -> bool:
        """Whether what the robot sees contradicts its map."""
        return self._mapper.is_lost

    def move(self, by: Pose) -> None:
        """Let the map lie elsewhere. Args: by: what was at pose p in `map` is at `by @ p`."""
        self._map_T_frame, self._has_moved = by @ self._map_T_frame, True

    def take_changes(self) -> tuple[Rectangle, np.ndarray]:
        """Bring the cells up to date; return a rectangle with all that have changed, and which have, bool."""
        (x_m, y_m), cells = self._mapper.take_changes(self._factor)
        row, column = round(y_m / CELL_M) + self._margin, round(x_m / CELL_M) + self._margin
        here, there = overlap(self._framed.shape, row, column, cells.shape)
        if not self._margin:
            changed = self.cells[here] != cells[there]
            self.cells[here] = cells[there]
            return here, changed
        self._framed[here] = cells[there]
        part = whole(self.cells) if self._has_moved else self._around(here)
        self._has_moved = False
        now = self._in_map(part)
        changed = self.cells[part] != now
        self.cells[part] = now
        return part, changed

    def _around(self, framed: Rectangle) -> Rectangle:
        """Return the cells of `map` in which a rectangle of the mapper's frame lies."""
        rows, columns = framed
        ends = [(x, y) for x in (columns.start, columns.stop) for y in (rows.start, rows.stop)]
        ends_m = moved(self._map_T_frame, CELL_M * (np.array(ends) - self._margin)) - self._origin_m
        low, high = np.floor(ends_m.min(axis=0) / CELL_M), np.ceil(ends_m.max(axis=0) / CELL_M)
        (left, bottom), (width, height) = low.astype(int).tolist(), (high - low).astype(int).tolist()
        return overlap(self.cells.shape, bottom, left, (height, width))[0]

    def _in_map(self, part: Rectangle) -> np.ndarray:
        """Return what the robot has mapped at some cells of `map`, int8: each has the cell in which its centre lies."""
        rows, columns = np.mgrid[part]
        centers_m = (np.stack((columns.ravel(), rows.ravel()), axis=1) + 0.5) * CELL_M + self._origin_m
        margin_m = CELL_M * self._margin
        framed_m = moved(self._map_T_frame.inverse(), centers_m)
        return cells_at(self._framed, framed_m, (-margin_m, -margin_m)).reshape(rows.shape)


def mapper_of(laser: Laser, mapping: Mapping, start: Pose) -> _core.maps.Mapper:
    """Return a mapper that has seen nothing. Args: start: of the robot, in the mapper's frame."""
    return _core.maps.Mapper(
        fan=core_fan(laser.beam_model().fan),
        range_min_m=laser.range_min_m,
        parameters=_core.maps.MapperParameters(**mapping.model_dump(exclude={"share_s", "starts"})),
        start=start,
    )


def whole(cells: np.ndarray) -> Rectangle:
    """Return the rectangle of all cells."""
    rows, columns = cells.shape
    return slice(0, rows), slice(0, columns)


def cells_at(cells: np.ndarray, points_m: np.ndarray, origin_m: Point) -> np.ndarray:
    """Return the cells of points, shape (n,); outside, they are UNKNOWN. Args: origin_m: of cell (0, 0)."""
    columns, rows = np.floor((points_m - origin_m) / CELL_M).astype(np.int64).T
    inside = (rows >= 0) & (rows < cells.shape[0]) & (columns >= 0) & (columns < cells.shape[1])
    found = np.full(len(points_m), UNKNOWN, dtype=np.int8)
    found[inside] = cells[rows[inside], columns[inside]]
    return found


def overlap(shape: tuple[int, ...], row: int, column: int, other: tuple[int, ...]) -> tuple[Rectangle, Rectangle]:
    """Return the same rectangle in two grids of cells, of which the second begins at a row and column of the first."""
    low, left = max(row, 0), max(column, 0)
    high, right = max(min(shape[0], row + other[0]), low), max(min(shape[1], column + other[1]), left)
    here = slice(low, high), slice(left, right)
    return here, (slice(low - row, high - row), slice(left - column, right - column))
