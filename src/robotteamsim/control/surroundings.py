"""What stands around a robot, as its laser sees it: the obstacle term of eq. (22)."""

from __future__ import annotations

import math

import numpy as np

from robotteamsim.control.navigation import scan_clearance
from robotteamsim.geometry import Pose
from robotteamsim.scenario.sections import Laser
from robotteamsim.swarm import Vector, obstacle_attractor

_BEAMS = 60
"""So many beams, at least, are enough to tell where there is room."""
_BEAM_WIDTH_M = 0.05
"""A place counts as seen free when a disc of this radius could go there."""


class Surroundings:
    """Finds x_OB: the place of best clearance within the sensing radius r_s that the laser sees to be free."""

    def __init__(self, laser: Laser, sensing_radius_m: float) -> None:
        self._stride = max(1, laser.beams // _BEAMS)
        beams = len(range(0, laser.beams, self._stride))
        last_rad = laser.angle_min_rad
        if laser.beams > 1:
            last_rad += (beams - 1) * self._stride * (laser.angle_max_rad - laser.angle_min_rad) / (laser.beams - 1)
        self._clearance = scan_clearance(laser.model_copy(update={"beams": beams, "angle_max_rad": last_rad}))
        self._radius_m = sensing_radius_m
        low_rad, high_rad = laser.angle_min_rad, laser.angle_max_rad
        self._headings_rad = np.linspace(low_rad, high_rad, 13).tolist()

    def attractor(self, pose: Pose, ranges_m: np.ndarray) -> Vector | None:
        """Return x_OB in `map` [m]; none where nothing is within the sensing radius (then c3 = 0)."""
        ranges_m = ranges_m[:: self._stride]
        if len(self._clearance.hits(ranges_m, self._radius_m)) == 0:
            return None
        hits_m = self._clearance.hits(ranges_m, 2.0 * self._radius_m)
        frees_m = self._clearance.free_distances(ranges_m, self._headings_rad, _BEAM_WIDTH_M, self._radius_m)
        candidates_m = [
            (reach_m * math.cos(heading_rad), reach_m * math.sin(heading_rad))
            for heading_rad, free_m in zip(self._headings_rad, frees_m, strict=True)
            for reach_m in (0.5 * self._radius_m, self._radius_m)
            if reach_m <= free_m
        ]
        x, y = obstacle_attractor((0.0, 0.0), hits_m, np.array(candidates_m).reshape(-1, 2))
        cos, sin = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
        return pose.x_m + cos * x - sin * y, pose.y_m + sin * x + cos * y
