"""Maps that a viewer shows as layers over the floor: voice levels, radio coverage, fire and smoke, as whole numbers."""

from __future__ import annotations

from dataclasses import dataclass

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
    return _merged(time_s, origin_m, cell_m, codes)


def smoke_layer(time_s: float, origin_m: tuple[float, float], cell_m: float, cells: np.ndarray) -> LayerMap:
    """Return the smoke: 0 where one sees 30 m far, 100 where one sees nothing. Args: cells: of /smoke/grid."""
    steps = (cells.clip(0, 100) + _SMOKE_STEP // 2) // _SMOKE_STEP * _SMOKE_STEP
    return _merged(time_s, origin_m, cell_m, steps.astype(np.int16))


def _merged(time_s: float, origin_m: tuple[float, float], cell_m: float, values: np.ndarray) -> LayerMap:
    """Return a map of no more cells than a viewer shows, each with the largest value of those that it merges."""
    stride = _stride(values)
    rows, columns = (np.arange(0, size, stride) for size in values.shape)
    merged = np.maximum.reduceat(np.maximum.reduceat(values, rows, axis=0), columns, axis=1)
    return LayerMap(time_s, origin_m, cell_m * stride, merged)


def _stride(values: np.ndarray) -> int:
    return max(int(np.ceil((values.size / MAX_CELLS) ** 0.5)), 1)
