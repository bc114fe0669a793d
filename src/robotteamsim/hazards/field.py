"""Fire, smoke and temperature over the floor at one time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from robotteamsim import _core
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.fire import BLOCK_M, Block, Fire
from robotteamsim.scenario.plan import Grid

NOT_BURNING, BURNING, BURNT_OUT = 0, 1, 2
"""States of a cell."""

FARTHEST_SIGHT_M = 30.0
"""Largest visibility that is reported [m]."""

_CO_PPM_PER_G_M3 = 1e6 * 0.02406 / 28.01
"""Parts per million of a gram of carbon monoxide in a cubic metre of air at 20 degC."""


class Ignited(NamedTuple):
    """A place of fuel that has begun to burn.

    fuel:       its name; "" in results of FDS.
    position_m: centre of the cell that burns first, in `map` [m].
    spread:     whether fire from elsewhere has reached it.
    """

    fuel: str
    position_m: Point
    spread: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class HazardField(Grid):
    """One value per cell, as ROS messages carry them. Nothing burns and there is no smoke outside the cells.

    temperatures_c: float32, shape (rows, cols), row 0 at the lowest y [degC].
    soot_g_m3:      float32, same shape: soot in the air [g/m^3].
    states:         uint8, same shape: NOT_BURNING, BURNING or BURNT_OUT.
    fire:           the constants of the models.

    Positions are arrays of shape (n, 2) in `map` [m]; results have the shape (n,).
    """

    temperatures_c: np.ndarray
    soot_g_m3: np.ndarray
    states: np.ndarray
    fire: Fire

    def temperature_c(self, positions_m: np.ndarray) -> np.ndarray:
        """Return the temperature at some places [degC]."""
        return self._values_at(self.temperatures_c, positions_m, self.fire.heat.ambient_c)

    def soot(self, positions_m: np.ndarray) -> np.ndarray:
        """Return the soot in the air at some places [g/m^3]."""
        return self._values_at(self.soot_g_m3, positions_m, 0.0)

    def extinction_per_m(self, positions_m: np.ndarray) -> np.ndarray:
        """Return the extinction coefficient of light at some places [1/m]."""
        return self.fire.soot.extinction_m2_g * self.soot(positions_m)

    def visibility_m(self, positions_m: np.ndarray) -> np.ndarray:
        """Return how far people see at some places: C/K [jin1978], at most 30 m [m]."""
        least = self.fire.soot.visibility_c / FARTHEST_SIGHT_M
        metres: np.ndarray = self.fire.soot.visibility_c / np.maximum(self.extinction_per_m(positions_m), least)
        return metres

    def co_ppm(self, positions_m: np.ndarray) -> np.ndarray:
        """Return the carbon monoxide at some places [ppm]; it spreads as soot does."""
        soot = self.fire.soot
        return self.soot(positions_m) * (soot.co_yield_g_g / soot.yield_g_g * _CO_PPM_PER_G_M3)

    def hot_blocks(self, limit_c: float) -> set[Block]:
        """Return the blocks with a cell that is at least as hot [degC]."""
        hot = np.argwhere(self.temperatures_c >= limit_c) + 0.5
        rows = np.floor(hot * self.resolution_m / BLOCK_M).astype(int).tolist()
        return {(row, column) for row, column in rows}

    def _values_at(self, values: np.ndarray, positions_m: np.ndarray, outside: float) -> np.ndarray:
        # NaN, of an absent robot, is nowhere.
        return _core.hazards.values_at(values, self.origin_m, self.resolution_m, positions_m, outside)
