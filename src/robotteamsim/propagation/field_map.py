"""A map of real values over the floor."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from robotteamsim.scenario.plan import OccupancyGrid


@dataclass(frozen=True, slots=True, eq=False)
class FieldMap:
    """One value per cell, valid at the cell's centre.

    origin_m: lower left corner of cell (0, 0) in `map` [m].
    values:   float32, shape (rows, cols), row 0 at the lowest y.
    """

    origin_m: tuple[float, float]
    resolution_m: float
    values: np.ndarray

    @classmethod
    def over(cls, grid: OccupancyGrid, values: np.ndarray) -> FieldMap:
        """Return a map with the cells of an occupancy grid."""
        return cls(grid.origin_m, grid.resolution_m, values)

    def cell_center(self, row: int, column: int) -> tuple[float, float]:
        """Return the centre (x, y) of a cell in `map` [m]."""
        return (
            self.origin_m[0] + (column + 0.5) * self.resolution_m,
            self.origin_m[1] + (row + 0.5) * self.resolution_m,
        )

    def contains(self, x_m: float, y_m: float) -> bool:
        """Whether a point lies in one of the cells."""
        row, column = self._cell_at(x_m, y_m)
        return bool(0 <= row < self.values.shape[0] and 0 <= column < self.values.shape[1])

    def value_at(self, x_m: float, y_m: float) -> float:
        """Return the value of the cell that contains a point. Raises: ValueError: the point is outside the map."""
        if not self.contains(x_m, y_m):
            raise ValueError(f"point ({x_m:g}, {y_m:g}) lies outside the map")
        return float(self.values[self._cell_at(x_m, y_m)])

    def _cell_at(self, x_m: float, y_m: float) -> tuple[int, int]:
        return (
            math.floor((y_m - self.origin_m[1]) / self.resolution_m),
            math.floor((x_m - self.origin_m[0]) / self.resolution_m),
        )


def map_array(shape: tuple[int, ...], out: np.ndarray | None, dtype: type = np.float32) -> np.ndarray:
    """Return the array for a map: `out`, or a new one.

    Args:   out: of that type and shape, C-contiguous, writeable; it is not copied.
    Raises: ValueError: `out` does not have these properties.
    """
    if out is None:
        return np.empty(shape, dtype=dtype)
    if out.shape != shape or out.dtype != dtype or not out.flags.c_contiguous or not out.flags.writeable:
        kind = "C-contiguous, writeable" if out.flags.c_contiguous and out.flags.writeable else "strided or read-only"
        raise ValueError(
            f"out must be {np.dtype(dtype)}, C-contiguous, writeable, of shape {shape}, "
            f"got {out.dtype}, {kind}, {out.shape}"
        )
    return out
