"""The radio loss of a wall of layers [itu_p2040]."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from robotteamsim.scenario.materials import Layer, Substance

PROPERTIES: dict[Substance, tuple[float, float, float, float]] = {
    "air": (1.0, 0.0, 0.0, 0.0),
    "concrete": (5.24, 0.0, 0.0462, 0.7822),
    "brick": (3.91, 0.0, 0.0238, 0.16),
    "plasterboard": (2.73, 0.0, 0.0085, 0.9395),
    "wood": (1.99, 0.0, 0.0047, 1.0718),
    "glass": (6.31, 0.0, 0.0036, 1.3394),
    "ceiling_board": (1.48, 0.0, 0.0011, 1.0750),
    "chipboard": (2.58, 0.0, 0.0217, 0.7800),
    "plywood": (2.71, 0.0, 0.33, 0.0),
    "marble": (7.074, 0.0, 0.0055, 0.9262),
    "metal": (1.0, 0.0, 1e7, 0.0),
}
"""a, b, c, d of each substance [itu_p2040, Table 3], of its lowest range of frequencies."""

_LIGHT_M_PER_S = 299_792_458.0
_SHARES = np.linspace(0.9, 1.1, 101)
"""Of the thickness, over which the power is averaged: real walls are not as even as their reflections would need."""
MOST_DB = 120.0
"""The largest loss of a wall, as of `radio.materials`."""
_OPAQUE_NP = MOST_DB / (20.0 * math.log10(math.e))
"""A greater attenuation of one layer [Np] lets nothing pass."""


def permittivity(substance: Substance, frequency_mhz: float) -> complex:
    """Return the complex relative permittivity a f^b - j 17.98 c f^d / f, f in GHz [itu_p2040, 2.1.4]."""
    a, b, c, d = PROPERTIES[substance]
    f_ghz = frequency_mhz / 1e3
    return complex(a * f_ghz**b, -17.98 * c * f_ghz**d / f_ghz)


def wall_loss_db(layers: Sequence[Layer], frequency_mhz: float) -> float:
    """Return the transmission loss of a wall at normal incidence, in whole tenths of a dB, at most `MOST_DB`.

    The transmitted power of the layers, with all reflections between them [itu_p2040, 2.2.2 and Attachment 1], is
    averaged over 10 % more and less of their thickness. It is the same from both sides.
    """
    # The ABCD matrix of each layer connects the electric and the magnetic field at its two faces.
    wave = np.broadcast_to(np.eye(2, dtype=complex), (len(_SHARES), 2, 2))
    for layer in layers:
        index = np.sqrt(permittivity(layer.of, frequency_mhz))
        phase = 2.0 * math.pi * frequency_mhz * 1e6 / _LIGHT_M_PER_S * index * layer.thickness_m * _SHARES
        if phase.imag.max() < -_OPAQUE_NP:  # also where it is thinnest
            return MOST_DB
        cos, sin = np.cos(phase), np.sin(phase)
        wave = wave @ np.moveaxis(np.array([[cos, 1j * sin / index], [1j * index * sin, cos]]), 2, 0)
    transmitted = np.abs(2.0 / wave.sum(axis=(1, 2))) ** 2
    return float(min(round(-10.0 * math.log10(transmitted.mean()), 1) + 0.0, MOST_DB))
