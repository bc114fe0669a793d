"""The obstacle term of eq. (22), from a robot's laser."""

import math

import numpy as np

from robotteamsim import _core
from robotteamsim.control.driving.navigation import laser_layout
from robotteamsim.scenario.sections import Laser

_BEAMS = 60
"""At least this many beams are used: with a field of view of 270 degrees, one every 4.5 degrees."""

_HEADINGS = 13
"""Number of equal sectors of the field of view whose borders are the compared directions."""


class Surroundings(_core.control.Surroundings):
    """Finds x_OB: the place with the best clearance within the sensing radius r_s that the laser sees as free.

    `clearest_place` returns the `obstacle_attractor` of the places along 13 headings, at half the radius and at the
    full radius, in `map` [m]; None if no obstacle is within the sensing radius (then c3 = 0).
    """

    def __init__(self, laser: Laser, sensing_radius_m: float) -> None:
        stride = max(1, laser.beams // _BEAMS)
        beams = len(range(0, laser.beams, stride))
        low_rad = last_rad = laser.angle_min_rad
        if laser.beams > 1:
            last_rad += (beams - 1) * stride * (laser.angle_max_rad - low_rad) / (laser.beams - 1)
        angles_rad = np.linspace(low_rad, laser.angle_max_rad, laser.beams)
        self._cos, self._sin = np.cos(angles_rad), np.sin(angles_rad)
        self._forward_m, self._longest_m = laser.forward_m, laser.range_max_m * (1.0 - 1e-6)
        super().__init__(
            laser=laser_layout(laser.model_copy(update={"beams": beams, "angle_max_rad": last_rad})),
            stride=stride,
            sensing_radius_m=sensing_radius_m,
            headings_rad=np.linspace(low_rad, laser.angle_max_rad, _HEADINGS).tolist(),
        )

    def clearance_m(self, ranges_m: np.ndarray) -> float:
        """Return the distance from base_link to the nearest obstacle that the laser sees [m]; infinite if none."""
        seen = ranges_m < self._longest_m
        if not seen.any():
            return math.inf
        ranges_m = ranges_m[seen]
        x_m, y_m = self._forward_m + ranges_m * self._cos[seen], ranges_m * self._sin[seen]
        return float(np.hypot(x_m, y_m).min())
