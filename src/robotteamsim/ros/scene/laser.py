"""Laser returns of the whole team as one coloured point cloud in the map frame."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sensor_msgs.msg import LaserScan, PointCloud2, PointField

from robotteamsim.geometry import Pose
from robotteamsim.ros.scene.shapes import FRAME
from robotteamsim.ros.scene.team import robot_colour

IN_FRONT_M = 0.06

_POINT = np.dtype([("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("rgb", "<u4")])


@dataclass(frozen=True, slots=True)
class ScanView:
    """One scan, and the pose of the laser in the map frame at that time.

    Ranges >= range_max, below range_min or not finite mean no return.
    """

    robot_id: int
    laser: Pose
    height_m: float
    scan: LaserScan


def scan_points_m(view: ScanView) -> np.ndarray:
    """Return the points that a scan hit, float64, shape (hits, 2), in the map frame [m].

    They are slightly in front of the obstacle, which would otherwise cover half of each point.
    """
    scan, laser = view.scan, view.laser
    ranges_m = np.asarray(scan.ranges, dtype=float)
    hit = np.isfinite(ranges_m) & (ranges_m >= scan.range_min) & (ranges_m < scan.range_max)
    angles_rad = laser.yaw_rad + scan.angle_min + scan.angle_increment * np.flatnonzero(hit)
    away = np.column_stack((np.cos(angles_rad), np.sin(angles_rad)))
    points_m: np.ndarray = np.array([laser.x_m, laser.y_m]) + (ranges_m[hit, None] - IN_FRONT_M) * away
    return points_m


def cloud(scans: Sequence[ScanView]) -> PointCloud2:
    """Return the returns of all scans in their robots' colours; the stamp is 0, as in all parts of the scene."""
    parts = []
    for scan in scans:
        points_m = scan_points_m(scan)
        part = np.empty(len(points_m), dtype=_POINT)
        part["x"], part["y"], part["z"] = points_m[:, 0], points_m[:, 1], scan.height_m
        red, green, blue = (round(255 * value) for value in robot_colour(scan.robot_id)[:3])
        part["rgb"] = red << 16 | green << 8 | blue
        parts.append(part)
    points = np.concatenate(parts) if parts else np.empty(0, dtype=_POINT)
    message = PointCloud2(height=1, width=len(points), point_step=_POINT.itemsize, is_dense=True)
    message.header.frame_id = FRAME
    message.row_step = len(points) * _POINT.itemsize
    message.data = points.tobytes()
    message.fields = [PointField(name, 4 * i, PointField.FLOAT32, 1) for i, name in enumerate(_POINT.names or ())]
    return message
