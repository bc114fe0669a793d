"""Whether the scans of a robot fit the floor plan at the pose that a localisation node gives it."""

from __future__ import annotations

import numpy as np
import shapely

from robotteamsim.geometry import Pose, PoseReading
from robotteamsim.scenario import FloorPlan
from robotteamsim.scenario.plan import obstacles
from robotteamsim.scenario.sections import Laser

PERIOD_NS = 10**9
CONTRADICTIONS = 5
"""So many checks in a row must fail before a warning."""
LEAST_DEPTH_M = 0.5
"""A beam goes through a wall if it is longer than to the wall by more than this."""
MOST_THROUGH = 0.2
"""Largest share of such beams. At poses with errors of 0.1 m and 0.05 rad, no five scans in a row have more."""
LEAST_BEAMS = 10
"""Scans of fewer beams are not checked."""


class ScanCheck:
    """Compares the scans of one robot with the plan, once a second.

    People, robots and objects only shorten beams, so only those through walls or outside the bounds count. Doors may be
    open.
    """

    def __init__(self, robot_name: str, plan: FloorPlan, laser: Laser, smoke: bool = False) -> None:
        """Args: robot_name: in the warning.  smoke: whether it may hide returns; then only beams with one count."""
        self._name = robot_name
        walls = obstacles(plan.model_copy(update={"doors": ()}))
        self._free = shapely.difference(shapely.box(*plan.bounds.min, *plan.bounds.max), walls)
        shapely.prepare(self._free)
        self._laser = laser
        self._smoke = smoke
        self._angles_rad = np.linspace(laser.angle_min_rad, laser.angle_max_rad, laser.beams)
        self.restart()

    def restart(self) -> None:
        """Restart with the first step, because time has jumped back."""
        self._due_ns = 0
        self._failed = 0

    def follow(self, step_ns: int, pose: PoseReading, ranges_m: np.ndarray) -> str:
        """Return in one line that the scans contradict the plan, in the step in which that becomes certain; else "".

        Args: step_ns: stamp of the step.  ranges_m: shape (beams,); a scan of another shape is not checked.
        """
        if step_ns < self._due_ns or ranges_m.shape != self._angles_rad.shape or len(ranges_m) < LEAST_BEAMS:
            return ""
        self._due_ns = step_ns + PERIOD_NS
        through = self._share_through_walls(pose.pose, ranges_m)
        self._failed = self._failed + 1 if through > MOST_THROUGH else 0
        if self._failed != CONTRADICTIONS:
            return ""
        return (
            f"{self._name}: {through:.0%} of its laser beams go through walls of the floor plan at its pose from tf, "
            f"({pose.x_m:.1f}, {pose.y_m:.1f}); is its initial pose right?"
        )

    def _share_through_walls(self, pose: Pose, ranges_m: np.ndarray) -> float:
        laser = pose @ Pose(self._laser.forward_m, self._laser.left_m, 0.0)
        longest_m = self._laser.range_max_m
        # A beam without a return is free up to the longest range. NaN shows nothing.
        free_m = np.clip(np.nan_to_num(ranges_m, nan=0.0, posinf=longest_m), 0.0, longest_m)
        if self._smoke:
            free_m[free_m >= longest_m] = 0.0
        lengths_m, angles_rad = np.maximum(free_m - LEAST_DEPTH_M, 0.0), laser.yaw_rad + self._angles_rad
        starts = np.broadcast_to((laser.x_m, laser.y_m), (len(lengths_m), 2))
        along = np.stack([np.cos(angles_rad), np.sin(angles_rad)], axis=1)
        beams = shapely.linestrings(np.stack([starts, starts + lengths_m[:, None] * along], axis=1))
        return float(np.mean(~shapely.covers(self._free, beams)))
