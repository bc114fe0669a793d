"""Fire and smoke as layers of small whole numbers."""

from __future__ import annotations

import numpy as np

from robotteamsim.hazards import HazardField
from robotteamsim.recording.topics.world import BURNING_VALUE, BURNT_OUT_VALUE, fire_cells, smoke_cells
from robotteamsim.view.layer_map import MAX_CELLS, LayerMap

_NOTHING, _HOT, _BURNT_OUT, _BURNING = range(4)
"""Values of the layer `fire`. Where cells are merged, the largest one is shown."""

SMOKE_S = 5.0
"""Time between smoke maps in a recording [s]."""

_SMOKE_STEP = 4
"""Smoke is kept in steps of 4 % of its range, which look the same in the page."""


def fire_layer(time_s: float, field: HazardField) -> LayerMap:
    """Return what burns, has burnt out, or is so hot that robots avoid it."""
    return fire_map(time_s, field.origin_m, field.resolution_m, fire_cells(field), _is_hot(field))


def fire_map(
    time_s: float, origin_m: tuple[float, float], cell_m: float, cells: np.ndarray, is_hot: np.ndarray
) -> LayerMap:
    """Return the same from the values of /fire/grid. Args: is_hot: bool, of the same shape."""
    codes = np.where(is_hot, _HOT, _NOTHING).astype(np.uint8)
    codes[cells == BURNT_OUT_VALUE] = _BURNT_OUT
    codes[cells == BURNING_VALUE] = _BURNING
    return _merged(time_s, origin_m, cell_m, codes)


def smoke_layer(time_s: float, field: HazardField) -> LayerMap:
    """Return the smoke: 0 where one sees 30 m far, 100 where one sees nothing."""
    return smoke_map(time_s, field.origin_m, field.resolution_m, smoke_cells(field))


def smoke_map(time_s: float, origin_m: tuple[float, float], cell_m: float, cells: np.ndarray) -> LayerMap:
    """Return the same from the values of /smoke/grid."""
    steps = (cells.clip(0, 100) + _SMOKE_STEP // 2) // _SMOKE_STEP * _SMOKE_STEP
    return _merged(time_s, origin_m, cell_m, steps.astype(np.uint8))


class HazardMaps:
    """The maps of fire and smoke of a mission: each map of the fire that differs, and the smoke every few seconds."""

    def __init__(self) -> None:
        self.fire: list[LayerMap] = []
        self.smoke: list[LayerMap] = []
        self._smoke_due_s = 0.0

    def add_fire(self, layer: LayerMap) -> None:
        """Keep a map if it differs from the last one."""
        if not self.fire or not np.array_equal(layer.values, self.fire[-1].values):
            self.fire.append(layer)

    def add_smoke(self, layer: LayerMap) -> None:
        """Keep a map if it is time for one."""
        if layer.time_s >= self._smoke_due_s:
            self._smoke_due_s = layer.time_s + SMOKE_S
            self.smoke.append(layer)


def _is_hot(field: HazardField) -> np.ndarray:
    hot: np.ndarray = field.temperatures_c >= field.fire.heat.block_c
    return hot


def _merged(time_s: float, origin_m: tuple[float, float], cell_m: float, values: np.ndarray) -> LayerMap:
    """Return a map of no more cells than a viewer shows, each with the largest value of those that it merges."""
    stride = max(int(np.ceil((values.size / MAX_CELLS) ** 0.5)), 1)
    rows, columns = (np.arange(0, size, stride) for size in values.shape)
    merged = np.maximum.reduceat(np.maximum.reduceat(values, rows, axis=0), columns, axis=1)
    return LayerMap(time_s, origin_m, cell_m * stride, merged)
