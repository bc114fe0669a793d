"""What smoke and heat do to firefighters: smoke slows them, and they collapse."""

from __future__ import annotations

import math
from collections.abc import Sequence

import msgspec
import numpy as np

from robotteamsim.geometry import Twist
from robotteamsim.hazards import Doses, HazardField, walking_speed_share
from robotteamsim.scenario.scenario import Scenario


class FirefighterHealth:
    """The doses of all firefighters, and how fast they walk in smoke, by the models of all other people."""

    def __init__(self, scenario: Scenario) -> None:
        section = scenario.firefighters
        assert scenario.fire is not None
        self._ids = scenario.firefighter_ids
        self._breathe_smoke = section is None or not section.breathing_apparatus
        self._doses = Doses(scenario.fire)
        self._shares: dict[int, float] = {}
        """Of their speed, by the id of those whom smoke slows."""

    def without(self, positions_m: np.ndarray) -> np.ndarray:
        """Return the positions of the team with NaN for firefighters."""
        if not self._ids:
            return positions_m
        others_m = positions_m.copy()
        others_m[self._ids.start : self._ids.stop] = math.nan
        return others_m

    def slowed(self, twists: Sequence[Twist]) -> Sequence[Twist]:
        """Return the commands of the team as firefighters can follow them in the smoke of the last update."""
        if not self._shares:
            return twists
        slowed = list(twists)
        for robot_id, share in self._shares.items():
            twist = slowed[robot_id]
            x_mps, y_mps = share * twist.linear_x_mps, share * twist.linear_y_mps
            slowed[robot_id] = msgspec.structs.replace(twist, linear_x_mps=x_mps, linear_y_mps=y_mps)
        return slowed

    def expose(self, positions_m: np.ndarray, field: HazardField, seconds: float) -> list[int]:
        """Add some time at these places [s]; return the ids of the firefighters who collapse now.

        Args: positions_m: of the whole team, shape (n, 2) [m]; NaN for somebody who is absent, and whose successor
              starts without a dose.
        """
        if not self._ids:
            return []
        own_m = positions_m[self._ids.start : self._ids.stop]
        shares = walking_speed_share(field.extinction_per_m(own_m)).tolist()
        self._shares = {i: share for i, share in zip(self._ids, shares, strict=True) if share < 1.0}
        for robot_id, (x_m, _) in zip(self._ids, own_m.tolist(), strict=True):
            if math.isnan(x_m):
                self._doses.forget(str(robot_id))
        names = [str(robot_id) for robot_id in self._ids]
        changed = self._doses.expose(names, own_m.tolist(), field, seconds, breathe_smoke=self._breathe_smoke)
        return [int(name) for name, state in changed.items() if state != "well"]
