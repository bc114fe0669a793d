#!/usr/bin/env python3
"""Maps like slam_gmapping, with its parameters, topics and frames, but trusts odometry: for tests without gmapping."""

from __future__ import annotations

import math

import numpy as np
import rospy
import tf2_ros
from nav_msgs.msg import OccupancyGrid
from sensor_msgs.msg import LaserScan

RESOLUTION_M = 0.05
CELLS = 800
"""The map is a square around the robot's start."""
PERIOD_SCANS = 20
TIMEOUT = rospy.Duration(60)
CACHE = rospy.Duration(3600)


class Mapper:
    """Marks the cells at the end of each beam that hit something."""

    def __init__(self) -> None:
        self.map_frame, self.odom_frame = (rospy.get_param(f"~{name}_frame") for name in ("map", "odom"))
        self.base_frame = rospy.get_param("~base_frame")
        self.transforms = tf2_ros.Buffer(cache_time=CACHE)
        self.listener = tf2_ros.TransformListener(self.transforms)
        self.cells = np.full((CELLS, CELLS), -1, np.int8)
        self.scans = 0
        self.publisher = rospy.Publisher("map", OccupancyGrid, queue_size=1, latch=True)
        rospy.Subscriber("scan", LaserScan, self.add, queue_size=1000)

    def add(self, scan: LaserScan) -> None:
        """Add a scan at its pose in odom."""
        stamp = scan.header.stamp
        self.transforms.lookup_transform(self.odom_frame, self.base_frame, stamp, TIMEOUT)
        laser = self.transforms.lookup_transform(self.odom_frame, scan.header.frame_id, stamp, TIMEOUT).transform
        yaw_rad = 2.0 * math.atan2(laser.rotation.z, laser.rotation.w)
        ranges_m = np.asarray(scan.ranges)
        angles_rad = yaw_rad + scan.angle_min + scan.angle_increment * np.arange(len(ranges_m))
        hit = ranges_m < scan.range_max
        x_m = laser.translation.x + (ranges_m * np.cos(angles_rad))[hit]
        y_m = laser.translation.y + (ranges_m * np.sin(angles_rad))[hit]
        rows, columns = (np.floor(values / RESOLUTION_M).astype(int) + CELLS // 2 for values in (y_m, x_m))
        self.cells[rows, columns] = 100
        self.scans += 1
        if self.scans % PERIOD_SCANS == 0:
            self.publish(stamp)

    def publish(self, stamp: rospy.Time) -> None:
        """Publish the map."""
        grid = OccupancyGrid()
        grid.header.frame_id, grid.header.stamp = self.map_frame, stamp
        grid.info.resolution, grid.info.width, grid.info.height = RESOLUTION_M, CELLS, CELLS
        grid.info.origin.position.x = grid.info.origin.position.y = -CELLS // 2 * RESOLUTION_M
        grid.info.origin.orientation.w = 1.0
        grid.data = self.cells.ravel().tolist()
        self.publisher.publish(grid)


if __name__ == "__main__":
    rospy.init_node("slam_gmapping")
    Mapper()
    rospy.spin()
