"""A map of real values over the floor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robotteamsim.scenario.plan import Grid


@dataclass(frozen=True, slots=True, eq=False)
class FieldMap(Grid):
    """One value per cell, valid at the cell's centre.

    values: float32, shape (rows, cols), row 0 at the lowest y.
    """

    values: np.ndarray

    def contains(self, x_m: float, y_m: float) -> bool:
        """Whether a point lies in one of the cells."""
        row, column = self.cell_at(x_m, y_m)
        return bool(0 <= row < self.values.shape[0] and 0 <= column < self.values.shape[1])

    def value_at(self, x_m: float, y_m: float) -> float:
        """Return the value of the cell that contains a point. Raises: ValueError: the point is outside the map."""
        if not self.contains(x_m, y_m):
            raise ValueError(f"point ({x_m:g}, {y_m:g}) lies outside the map")
        return float(self.values[self.cell_at(x_m, y_m)])


def map_array(shape: tuple[int, ...], out: np.ndarray | None) -> np.ndarray:
    """Return the array for a map: `out`, or a new one.

    Args:   out: float32, of that shape, C-contiguous, writeable; it is not copied.
    Raises: ValueError: `out` does not have these properties.
    """
    if out is None:
        return np.empty(shape, dtype=np.float32)
    if out.shape != shape or out.dtype != np.float32 or not out.flags.c_contiguous or not out.flags.writeable:
        kind = "C-contiguous, writeable" if out.flags.c_contiguous and out.flags.writeable else "strided or read-only"
        raise ValueError(
            f"out must be float32, C-contiguous, writeable, of shape {shape}, got {out.dtype}, {kind}, {out.shape}"
        )
    return out
