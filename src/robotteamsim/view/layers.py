"""Maps that a viewer shows as layers over the floor: voice levels, radio coverage, fire and smoke, as whole numbers."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from robotteamsim.hazards import HazardField
from robotteamsim.propagation import FieldMap
from robotteamsim.recording.topics.world import BURNING_VALUE, BURNT_OUT_VALUE, fire_cells, smoke_cells

MAX_CELLS = 40_000
"""Most cells of a map that is shown; finer maps are thinned out."""

LOWEST_DBM = -120.0
"""Weaker signals are not shown."""

SMOKE_S = 5.0
"""Time between smoke maps in a recording [s]."""

_NOTHING, _HOT, _BURNT_OUT, _BURNING = range(4)
"""Values of the layer `fire`. Where cells are merged, the largest one is shown."""

_SMOKE_STEP = 4
"""Smoke is kept in steps of 4 % of its range, which look the same in the page."""


@dataclass(frozen=True, slots=True)
class LayerMap:
    """One map of a layer, from a time on [s]: whole numbers in rows from the lower left corner `origin_m`."""

    time_s: float
    origin_m: tuple[float, float]
    cell_m: float
    values: np.ndarray


def keep_map(maps: list[LayerMap], layer: LayerMap, period_s: float = 0.0) -> None:
    """Add a map to those of a layer if it differs from the last one, which is at least `period_s` old [s]."""
    if not maps or (layer.time_s >= maps[-1].time_s + period_s and not np.array_equal(layer.values, maps[-1].values)):
        maps.append(layer)


def field_layer(time_s: float, field_map: FieldMap, lowest: float) -> LayerMap:
    """Return levels for a layer, thinned out if there are very many. Args: lowest: replaces those below or unknown."""
    stride = _stride(field_map.values)
    known = np.nan_to_num(field_map.values[::stride, ::stride], nan=lowest, posinf=lowest, neginf=lowest)
    values = np.rint(np.maximum(known, lowest)).astype(np.int16)
    return LayerMap(time_s, field_map.origin_m, field_map.resolution_m * stride, values)


def hazard_layers(time_s: float, field: HazardField) -> dict[str, LayerMap]:
    """Return the layers `fire` and `smoke`."""
    is_hot = field.temperatures_c >= field.fire.heat.block_c
    return {
        "fire": fire_layer(time_s, field.origin_m, field.resolution_m, fire_cells(field), is_hot),
        "smoke": smoke_layer(time_s, field.origin_m, field.resolution_m, smoke_cells(field)),
    }


def fire_layer(
    time_s: float, origin_m: tuple[float, float], cell_m: float, cells: np.ndarray, is_hot: np.ndarray
) -> LayerMap:
    """Return what burns, has burnt out, or is so hot that robots avoid it.

    Args: cells: of /fire/grid.  is_hot: bool, of the same shape.
    """
    codes = np.where(is_hot, _HOT, _NOTHING).astype(np.int16)
    codes[cells == BURNT_OUT_VALUE] = _BURNT_OUT
    codes[cells == BURNING_VALUE] = _BURNING
    return merged(time_s, origin_m, cell_m, codes)


def smoke_layer(time_s: float, origin_m: tuple[float, float], cell_m: float, cells: np.ndarray) -> LayerMap:
    """Return the smoke: 0 where one sees 30 m far, 100 where one sees nothing. Args: cells: of /smoke/grid."""
    steps = (cells.clip(0, 100) + _SMOKE_STEP // 2) // _SMOKE_STEP * _SMOKE_STEP
    return merged(time_s, origin_m, cell_m, steps.astype(np.int16))


def merged(
    time_s: float, origin_m: tuple[float, float], cell_m: float, values: np.ndarray, most_cells: int = MAX_CELLS
) -> LayerMap:
    """Return a map of no more cells than a viewer shows, each with the largest value of those that it merges."""
    stride = _stride(values, most_cells)
    rows, columns = (np.arange(0, size, stride) for size in values.shape)
    merged = np.maximum.reduceat(np.maximum.reduceat(values, rows, axis=0), columns, axis=1)
    return LayerMap(time_s, origin_m, cell_m * stride, merged)


def _stride(values: np.ndarray, most_cells: int = MAX_CELLS) -> int:
    return max(int(np.ceil((values.size / most_cells) ** 0.5)), 1)


class Film:
    """Maps of one floor over time, of which only the changes are kept; before the first one, all cells are 0."""

    def __init__(self, maps: Iterable[LayerMap] = ()) -> None:
        self._place: dict[str, Any] | None = None
        self._before = np.zeros(0, dtype=np.int64)
        self._times_s: list[float] = []
        self._cells: list[np.ndarray] = []
        self._changes: list[np.ndarray] = []
        for one in maps:
            self.add(one)

    def add(self, one: LayerMap) -> None:
        """Add a map of the same floor."""
        rows, columns = one.values.shape
        if self._place is None:
            self._place = {"origin_m": one.origin_m, "cell_m": one.cell_m, "rows": rows, "columns": columns}
            self._before = np.zeros(rows * columns, dtype=np.int64)
        now = one.values.ravel().astype(np.int64)
        changed = np.flatnonzero(now != self._before)
        self._times_s.append(one.time_s)
        self._cells.append(np.diff(changed, prepend=0))
        self._changes.append((now - self._before)[changed])
        self._before = now

    def packed(self) -> dict[str, Any] | None:
        """Return cells that change, by the differences of their places, and by how much; None without maps."""
        if self._place is None:
            return None
        cells, changes = ([part.tolist() for part in parts] for parts in (self._cells, self._changes))
        return self._place | {"times_s": self._times_s, "cells": cells, "changes": changes}
