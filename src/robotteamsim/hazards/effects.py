"""What smoke and heat do to sight, people and robots. docs/fire.md has the sources of all numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from robotteamsim.hazards.field import HazardField
from robotteamsim.scenario.fire import Fire

COMFORTABLE_C = 40.0
"""Below this temperature, hot air adds nothing to a dose [degC]."""

SLOWEST_SHARE = 0.1
"""People walk at least at this share of their speed, however dense the smoke."""

_FRANTZICH_NILSSON_M = -0.057 / 0.706
"""Slope over intercept of the walking speed over the extinction coefficient [frantzich2003] [m]."""

PersonState = Literal["well", "collapsed", "dead"]


def walking_speed_share(extinction_per_m: np.ndarray) -> np.ndarray:
    """Return the share of their speed at which people walk in smoke of these extinction coefficients [1/m]."""
    return np.maximum(SLOWEST_SHARE, 1.0 + _FRANTZICH_NILSSON_M * np.asarray(extinction_per_m))


def gas_dose_per_min(co_ppm: float) -> float:
    """Return the growth of the fractional effective dose by carbon monoxide [purser2016]."""
    return 2.764e-5 * math.pow(co_ppm, 1.036)


def heat_dose_per_min(temperature_c: float) -> float:
    """Return the growth of the fractional effective dose by hot air, for clothed people [iso13571]."""
    return math.pow(temperature_c, 3.61) / 4.1e8 if temperature_c > COMFORTABLE_C else 0.0


class Dose(NamedTuple):
    """The fractional effective doses of a person: the first of them that reaches 1 makes people collapse."""

    gas: float = 0.0
    heat: float = 0.0

    @property
    def worst(self) -> float:
        """The larger one."""
        return max(self.gas, self.heat)


class Doses:
    """The doses of people, by name. A dose never falls."""

    def __init__(self, fire: Fire) -> None:
        self._limits = fire.casualties
        self._doses: dict[str, Dose] = {}

    def of(self, name: str) -> Dose:
        """Return the dose of a person; 0 for one who has not been exposed."""
        return self._doses.get(name, Dose())

    def state(self, name: str) -> PersonState:
        """Return the state of a person by their dose."""
        worst = self.of(name).worst
        if worst >= self._limits.lethal_dose:
            return "dead"
        return "collapsed" if worst >= self._limits.collapse_dose else "well"

    def expose(
        self,
        names: Sequence[str],
        positions_m: Sequence[tuple[float, float]],
        field: HazardField,
        seconds: float,
        *,
        breathe_smoke: bool = True,
    ) -> dict[str, PersonState]:
        """Add the doses of some time at these places [s]; return the people whose state has changed, in their order.

        Args: positions_m: NaN for somebody who is absent.  breathe_smoke: False: breathing apparatus, no dose by gas.
        """
        if not names:
            return {}
        places = np.array(positions_m, dtype=np.float64)
        minutes = seconds / 60.0
        co_ppm = field.co_ppm(places).tolist() if breathe_smoke else [0.0] * len(names)
        temperatures_c = field.temperature_c(places).tolist()
        changed = {}
        for name, ppm, temperature_c in zip(names, co_ppm, temperatures_c, strict=True):
            if ppm == 0.0 and temperature_c <= COMFORTABLE_C:
                continue
            before, dose = self.state(name), self.of(name)
            more_gas, more_heat = gas_dose_per_min(ppm) * minutes, heat_dose_per_min(temperature_c) * minutes
            self._doses[name] = Dose(dose.gas + more_gas, dose.heat + more_heat)
            if self.state(name) != before:
                changed[name] = self.state(name)
        return changed

    def forget(self, name: str) -> None:
        """Start with no dose again, for a person who was replaced."""
        self._doses.pop(name, None)


class HeatStress:
    """The time that each robot has spent above the temperature that it endures."""

    def __init__(self, fire: Fire, num_robots: int) -> None:
        self._heat = fire.heat
        self._hot_s = [0.0] * num_robots

    def expose(self, positions_m: np.ndarray, field: HazardField, seconds: float) -> list[int]:
        """Add some time at these places [s]; return the ids of the robots that fail now.

        Args: positions_m: of all robots, shape (n, 2) [m]; NaN for an absent robot, which is forgotten.
        """
        failing, limit_c = [], self._heat.robot_limit_c
        for robot_id, temperature_c in enumerate(field.temperature_c(positions_m).tolist()):
            if temperature_c > limit_c:
                self._hot_s[robot_id] += seconds
                if self._hot_s[robot_id] >= self._heat.robot_endures_s:
                    failing.append(robot_id)
                    self._hot_s[robot_id] = 0.0
            elif self._hot_s[robot_id] and math.isnan(positions_m[robot_id, 0]):
                self._hot_s[robot_id] = 0.0
        return failing
