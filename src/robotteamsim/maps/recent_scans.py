"""The scans of the last metres that a robot drove, placed by its odometry."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from robotteamsim.geometry import Pose
from robotteamsim.maps.teammates import Disc
from robotteamsim.scenario.sensors.laser import Laser

_EVERY_M, _EVERY_RAD = 0.25, 0.25
"""Distance driven, or turn, between two scans that are kept [m, rad]."""

CELL_M = 0.1
"""Points in one cell count as one [m]."""


class Scan(NamedTuple):
    """One scan.

    odometry: pose of the robot in `odom`.
    ranges_m: float32, shape (beams,).
    beams:    indices of those that did not end at teammates, int32.
    """

    odometry: Pose
    ranges_m: np.ndarray
    beams: np.ndarray


class LaserView:
    """Where the beams of a laser end."""

    def __init__(self, laser: Laser) -> None:
        self.laser, self._offset_m = laser, math.hypot(laser.forward_m, laser.left_m)
        self._angles_rad = laser.angles_rad
        self._directions = np.stack((np.cos(self._angles_rad), np.sin(self._angles_rad)), axis=1)

    def ends_m(self, ranges_m: np.ndarray) -> np.ndarray:
        """Return the ends in base_link, shape (beams, 2) [m]; without a return, at the longest range."""
        limited_m = np.clip(ranges_m.astype(float), self.laser.range_min_m, self.laser.range_max_m)
        return np.asarray((self.laser.forward_m, self.laser.left_m) + limited_m[:, None] * self._directions)

    def hits(self, ranges_m: np.ndarray) -> np.ndarray:
        """Return whether each beam hit something, bool, shape (beams,)."""
        return np.asarray((ranges_m > self.laser.range_min_m) & (ranges_m < self.laser.range_max_m))

    def end_in(self, discs: Sequence[Disc], pose: Pose, ends_m: np.ndarray) -> np.ndarray:
        """Return whether each beam ends in one of the discs, for a robot at a pose: bool, shape (beams,)."""
        to_base_link, reach_m = pose.inverse(), self.laser.range_max_m + self._offset_m
        near: list[tuple[float, float, float]] = []
        for (x_m, y_m), radius_m in discs:
            if math.hypot(x_m - pose.x_m, y_m - pose.y_m) <= reach_m + radius_m:
                center = to_base_link @ Pose(x_m, y_m, 0.0)
                near.append((center.x_m, center.y_m, radius_m))
        xs_m, ys_m, radii_m = np.array(near).reshape(-1, 3, 1).swapaxes(0, 1)
        is_inside = (ends_m[:, 0] - xs_m) ** 2 + (ends_m[:, 1] - ys_m) ** 2 <= radii_m**2
        return np.asarray(is_inside.any(axis=0))

    def misses(self, discs: Sequence[Disc], pose: Pose, ranges_m: np.ndarray, narrowest_m: float) -> bool:
        """Whether a robot at a pose looks through one of the discs: what is said to be there is not.

        Args: narrowest_m: no robot is narrower; beams between which one fits show nothing.
        """
        sensor = pose @ Pose(self.laser.forward_m, self.laser.left_m, 0.0)
        for (x_m, y_m), radius_m in discs:
            center = sensor.inverse() @ Pose(x_m, y_m, 0.0)
            away_m = math.hypot(center.x_m, center.y_m)
            if not radius_m < away_m < self.laser.range_max_m - radius_m:
                continue
            half_rad, far_m = math.asin(radius_m / away_m), away_m + radius_m
            turned_rad = self._angles_rad - math.atan2(center.y_m, center.x_m)
            turned_rad = np.arctan2(np.sin(turned_rad), np.cos(turned_rad))
            into = np.abs(turned_rad) <= half_rad
            gaps_rad = np.diff(np.sort([-half_rad, *turned_rad[into], half_rad]))
            if gaps_rad.max() * far_m <= narrowest_m and np.all(ranges_m[into] > far_m):
                return True
        return False

    def hits_m(self, scan: Scan) -> np.ndarray:
        """Return where beams hit something, in base_link, shape (n, 2) [m]."""
        hits = self.hits(scan.ranges_m[scan.beams])
        return np.asarray(self.ends_m(scan.ranges_m)[scan.beams[hits]])


class RecentScans:
    """Scans some way apart, over a length driven."""

    def __init__(self, view: LaserView, length_m: float) -> None:
        self._view, self._length_m = view, length_m
        self._scans: deque[tuple[float, Scan]] = deque()

    def add(self, driven_m: float, scan: Scan) -> None:
        """Add a scan, unless the last one is too near; its arrays are copied. Args: driven_m: since the start [m]."""
        if self._scans:
            since = self._scans[-1][1].odometry.inverse() @ scan.odometry
            if math.hypot(since.x_m, since.y_m) < _EVERY_M and abs(since.yaw_rad) < _EVERY_RAD:
                return
        self._scans.append((driven_m, scan._replace(ranges_m=scan.ranges_m.copy())))
        self.forget_before(driven_m - self._length_m)

    def forget_before(self, driven_m: float) -> None:
        """Forget the scans before a length driven since the start [m]."""
        while self._scans and self._scans[0][0] < driven_m:
            self._scans.popleft()

    def seen_from(self, odometry: Pose) -> list[tuple[Pose, Scan]]:
        """Return where the robot was at each scan, in the frame of its pose in `odom` now, and the scan."""
        return [(odometry.inverse() @ scan.odometry, scan) for _, scan in self._scans]

    def points_m(self, odometry: Pose, most: int) -> np.ndarray:
        """Return where several scans hit something, in base_link, shape (n, 2) [m]: at most so many, spread evenly.

        What only one scan has hit may move, such as a teammate, and is left out.
        """
        cells = [
            np.unique(np.round(moved(pose, self._view.hits_m(scan)) / CELL_M).astype(np.int64), axis=0)
            for pose, scan in self.seen_from(odometry)
        ]
        distinct, counts = np.unique(np.concatenate(cells), axis=0, return_counts=True)
        return evenly(distinct[counts > 1], most) * CELL_M


def evenly(items: np.ndarray, most: int) -> np.ndarray:
    """Return at most so many items, spread evenly."""
    return np.asarray(items[np.linspace(0, len(items) - 1, min(most, len(items))).round().astype(int)])


def moved(pose: Pose, points_m: np.ndarray) -> np.ndarray:
    """Return points of a frame with that pose, shape (n, 2) [m]."""
    (x_m, y_m), cos, sin = points_m.T, math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
    # Not a product of matrices, whose last bits depend on the processor.
    return np.column_stack((cos * x_m - sin * y_m + pose.x_m, sin * x_m + cos * y_m + pose.y_m))
