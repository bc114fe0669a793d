"""What stands around a robot, as its laser sees it: the obstacle term of eq. (22)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from robotteamsim import _core
from robotteamsim.control.driving.navigation import laser_layout
from robotteamsim.geometry import Pose
from robotteamsim.scenario.sections import Laser
from robotteamsim.swarm import Vector

_BEAMS = 60
"""So many beams, at least, are enough to tell where there is room."""

_HEADINGS = 13


class Surroundings:
    """Finds x_OB: the place of best clearance within the sensing radius r_s that the laser sees to be free."""

    def __init__(self, laser: Laser, sensing_radius_m: float) -> None:
        stride = max(1, laser.beams // _BEAMS)
        beams = len(range(0, laser.beams, stride))
        low_rad = last_rad = laser.angle_min_rad
        if laser.beams > 1:
            last_rad += (beams - 1) * stride * (laser.angle_max_rad - low_rad) / (laser.beams - 1)
        core = _core.control.Surroundings(
            laser=laser_layout(laser.model_copy(update={"beams": beams, "angle_max_rad": last_rad})),
            stride=stride,
            sensing_radius_m=sensing_radius_m,
            headings_rad=np.linspace(low_rad, laser.angle_max_rad, _HEADINGS).tolist(),
        )
        # Not wrapped: every robot asks in every iteration.
        self.attractor: Callable[[Pose, np.ndarray], Vector | None] = core.clearest_place
        """Returns x_OB in `map` [m]; none where nothing is within the sensing radius (then c3 = 0).

        Of a pose and ranges [m], it is the `obstacle_attractor` of the places along 13 headings, at half the radius and
        at all of it.
        """
