"""The loss of voices at a wall of layers, by its mass."""

from __future__ import annotations

import math
from collections.abc import Sequence

from robotteamsim.propagation.slab import MOST_DB
from robotteamsim.scenario.materials import Layer, Substance

DENSITIES_KG_M3: dict[Substance, float] = {
    "air": 1.2,
    "concrete": 2400.0,
    "brick": 1800.0,
    "plasterboard": 900.0,
    "wood": 500.0,
    "glass": 2500.0,
    "ceiling_board": 300.0,
    "chipboard": 600.0,
    "plywood": 500.0,
    "marble": 2800.0,
    "metal": 7800.0,
}
"""Typical ones; a tenth more or less changes the loss by 0.9 dB."""

_AIR_KG_M2_S = 413.0
"""Characteristic impedance of air at 20 degC."""

_FIELD_INCIDENCE_DB = 5.0
"""Sound from all directions up to 78 degrees loses less than at normal incidence."""


def mass_law_loss_db(layers: Sequence[Layer], frequency_hz: float) -> float:
    """Return the sound reduction index of a wall by its mass, in whole tenths of a dB, from 0 to `MOST_DB`.

    The mass law of limp walls for field incidence [ebbitt2007]: 20 log10(pi f m / (rho c)) - 5 dB, which is
    20 log10(f m) - 47.4 dB, with m = mass per area of all layers [kg/m^2].
    """
    mass_kg_m2 = sum(DENSITIES_KG_M3[layer.of] * layer.thickness_m for layer in layers)
    normal_db = 20.0 * math.log10(math.pi * frequency_hz * mass_kg_m2 / _AIR_KG_M2_S)
    return min(max(round(normal_db - _FIELD_INCIDENCE_DB, 1), 0.0), MOST_DB)
