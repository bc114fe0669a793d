"""Maps that a viewer shows as a layer over the floor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robotteamsim.propagation import FieldMap

MAX_CELLS = 40_000
"""Most cells of a map that is shown; finer maps are thinned out."""


@dataclass(frozen=True, slots=True)
class LayerMap:
    """One map of a layer, from a time on [s]: values in rows from the lower left corner `origin_m`."""

    time_s: float
    origin_m: tuple[float, float]
    cell_m: float
    values: np.ndarray


def layer_map(time_s: float, field_map: FieldMap) -> LayerMap:
    """Return a map for a layer, thinned out if it has very many cells."""
    stride = max(int(np.ceil((field_map.values.size / MAX_CELLS) ** 0.5)), 1)
    cell_m = field_map.resolution_m * stride
    return LayerMap(time_s, field_map.origin_m, cell_m, field_map.values[::stride, ::stride])
