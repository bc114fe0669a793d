"""The floor that the team has covered, as far as one robot knows, and the message about it."""

import functools
import math
from collections.abc import Collection, Sequence

import msgspec
import numpy as np

from robotteamsim.control.driving.known_map import GRID_RESOLUTION_M, known_map
from robotteamsim.interface.discovery import Discovery
from robotteamsim.interface.payload import Index, Point, Update, update_reader
from robotteamsim.scenario.building import MapSource
from robotteamsim.scenario.fire import BLOCK_M, Block
from robotteamsim.scenario.levels import Traveller
from robotteamsim.swarm import Vector

CELL_M = BLOCK_M
"""Cells are the blocks of `HotPlaces`. Updates contain one bit per cell: 600 hexadecimal digits for 60 x 40 m."""

_KEPT_LENGTHS = 256
"""Cells whose path lengths to all others are kept: 5 MB for 60 x 40 m, of 46 MB for all cells."""

_KEPT_TEXTS = 64
"""Messages whose covered cells are kept: those that all of a team receive in a few steps."""

Disc = tuple[Vector, float]
"""Centre in `map` and radius [m]."""


class _Floor:
    """The cells of a plan for a robot of one size; expensive results are cached."""

    def __init__(self, building: MapSource, robot_radius_m: float, by: Traveller) -> None:
        plan = building.plan
        self.grid = known_map(building, robot_radius_m, by=by).grid
        self.origin_m = low_m = plan.bounds.min
        columns, rows = (math.ceil((high - low) / CELL_M) for low, high in zip(low_m, plan.bounds.max, strict=True))
        self.shape = rows, columns
        self.middles_m = np.stack(np.meshgrid(np.arange(columns) + 0.5, np.arange(rows) + 0.5), axis=-1) * CELL_M
        self.middles_m += self.origin_m
        self.places: list[list[Vector | None]] = [
            [self.grid.nearest_free(tuple(middle), 0.4 * CELL_M) for middle in row] for row in self.middles_m.tolist()
        ]
        """Per cell, a free place at its centre or close to it."""
        # Free places are centres of the grid's cells, so rounding cannot put one into another cell.
        origin_x, origin_y = self.origin_m
        found = [[place or (origin_x, origin_y) for place in row] for row in self.places]
        cells = np.floor((np.array(found) - self.origin_m) / GRID_RESOLUTION_M).astype(np.int64)
        self._columns, self._rows = cells[..., 0], cells[..., 1]
        self._has_place = np.array([[place is not None for place in row] for row in self.places])
        self.lengths_m = functools.lru_cache(_KEPT_LENGTHS)(self._lengths_of)
        self.cells_in = functools.lru_cache(_KEPT_TEXTS)(self._cells_in)

    def reachable(self, start: Vector) -> np.ndarray:
        """Return which cells can be reached from a place in `map` [m], bool, shape (rows, cols)."""
        free = self.grid.nearest_free(start, 1.0)
        return np.isfinite(self._lengths_from(free)) if free else np.zeros(self.shape, dtype=bool)

    def _lengths_of(self, cell: tuple[int, int]) -> np.ndarray | None:
        """Return the lengths of free paths from one cell's place to those of all cells, shape (rows, cols) [m].

        None if the cell has no free place.
        """
        place = self.places[cell[0]][cell[1]]
        return None if place is None else self._lengths_from(place)

    def _cells_in(self, text: str) -> np.ndarray | None:
        """Return the covered cells in a text from `FloorCover.to_hex`, bool, shape (rows, cols).

        None if it does not fit this floor. Do not change them.
        """
        size = math.prod(self.shape)
        try:
            bits = np.unpackbits(np.frombuffer(bytes.fromhex(text), dtype=np.uint8))
        except ValueError:
            return None
        return bits[:size].reshape(self.shape).astype(bool) if len(bits) == 8 * math.ceil(size / 8) else None

    def _lengths_from(self, start: Vector) -> np.ndarray:
        field = self.grid.distance_map(start)
        return np.where(self._has_place, field[self._rows, self._columns], math.inf)


class FloorCover:
    """The floor as cells of 1 m; a cell is covered once a robot was within `radius_m` of its centre and saw it."""

    def __init__(
        self, building: MapSource, robot_radius_m: float, start: Vector, radius_m: float, by: Traveller = "robots"
    ) -> None:
        """Args: by: who goes between levels: robots, or people and firefighters."""
        self._floor = building.shared(_Floor, robot_radius_m, by)
        self._open = self._floor.reachable(start)
        self._radius_m = radius_m
        self._covered = np.zeros_like(self._open)
        self._reach = math.floor(radius_m / CELL_M)
        offsets_m = np.arange(-self._reach, self._reach + 1) * CELL_M
        self._disc = np.argwhere(np.hypot(offsets_m[:, None], offsets_m[None, :]) <= radius_m)

    @property
    def share(self) -> float:
        """The fraction of reachable cells that are covered; 1 if there are none."""
        num_open = np.count_nonzero(self._open)
        return float(np.count_nonzero(self._covered & self._open) / num_open) if num_open else 1.0

    def look(self, position: Vector) -> None:
        """Mark the cells that a robot sees from a place in `map` [m] as covered."""
        start = self._floor.grid.nearest_free(position, 0.5)
        if start is None:
            return
        row, column = self._cell_of(position)
        low, left = max(row - self._reach - 1, 0), max(column - self._reach - 1, 0)
        around = slice(low, row + self._reach + 2), slice(left, column + self._reach + 2)
        away_m = self._floor.middles_m[around] - position
        near = away_m[..., 0] ** 2 + away_m[..., 1] ** 2 <= self._radius_m**2
        for up, right in np.argwhere(near & self._open[around] & ~self._covered[around]).tolist():
            cell = low + up, left + right
            place = self._floor.places[cell[0]][cell[1]]
            self._covered[cell] = place is not None and self._floor.grid.is_line_free(start, place)

    def best_place(
        self,
        position: Vector,
        left_out: Sequence[Disc],
        nearness_m: float,
        within: np.ndarray | None = None,
        hot: Collection[Block] = (),
    ) -> Vector | None:
        """Return the place with the most newly covered floor / (distance + `nearness_m`); the first one of ties.

        Args: left_out: discs, centre and radius [m], whose cells are not considered.
              within: the only cells to consider, bool, shape (rows, cols); None for all.
              hot: cells that are not considered; those outside the plan are ignored.
        """
        lengths_m = self._floor.lengths_m(self._cell_of(position))
        missing = self._open & ~self._covered
        if within is not None:
            missing &= within
        for block in hot:
            if block[0] < missing.shape[0] and block[1] < missing.shape[1]:
                missing[block] = False
        for center, radius_m in left_out:
            away_m = self._floor.middles_m - center
            missing &= away_m[..., 0] ** 2 + away_m[..., 1] ** 2 > radius_m**2
        if lengths_m is None or not missing.any():
            return None
        near = self._in_disc(missing)
        worth = np.where(missing, near / (lengths_m + nearness_m), 0.0)
        row, column = np.unravel_index(np.argmax(worth), worth.shape)
        return self._floor.places[row][column] if worth[row, column] > 0.0 else None

    def _in_disc(self, cells: np.ndarray) -> np.ndarray:
        """Return for each cell how many of the given ones, bool, are within the radius; int64, of the same shape."""
        padded = np.pad(cells, self._reach).astype(np.int64)
        rows, columns = cells.shape
        counts = np.zeros(cells.shape, dtype=np.int64)
        for row, column in self._disc:
            counts += padded[row : row + rows, column : column + columns]
        return counts

    def is_covered(self, place: Vector) -> bool:
        """Whether the cell that contains a place in `map` [m] is covered."""
        return bool(self._covered[self._cell_of(place)])

    def to_hex(self) -> str:
        """Return the covered cells as text for a message."""
        return np.packbits(self._covered).tobytes().hex()

    def merge(self, text: str) -> bool:
        """Add the covered cells in a text from `to_hex`. Returns: whether the text fits this floor."""
        cells = self._floor.cells_in(text)
        if cells is None:
            return False
        self._covered |= cells
        return True

    def _cell_of(self, place: Vector) -> tuple[int, int]:
        rows, columns = self._covered.shape
        row = math.floor((place[1] - self._floor.origin_m[1]) / CELL_M)
        column = math.floor((place[0] - self._floor.origin_m[0]) / CELL_M)
        return min(max(row, 0), rows - 1), min(max(column, 0), columns - 1)


class CoverUpdate(Update, frozen=True, tag="cover"):
    """Sent once per iteration: position and goal, in `map` [m], the cells known to be covered, and the known victims.

    discoveries: of victims, without names; `time_s` is simulated time. The mission reads them, too.
    hot:         blocks of hot places that the sender sees, sorted, and the highest temperature in each [degC]; left out
                 by those who see none.
    """

    robot_id: Index
    position: Point
    goal: Point | None
    covered: str
    discoveries: tuple[Discovery, ...]
    hot: tuple[tuple[Index, Index, int], ...] | msgspec.UnsetType = msgspec.UNSET


parse_cover_update = update_reader(CoverUpdate, kept=1024)
"""Return the update in a message; None if it is another message."""
