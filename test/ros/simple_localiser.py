#!/usr/bin/env python3
"""Locates like amcl, with its parameters, topics and frames, but trusts odometry: for tests without amcl.

Where amcl would end or be wrong because of its parameters, it ends. WRONG_START is added to the initial pose.
"""

from __future__ import annotations

import os

import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped
from nav_msgs.srv import GetMap
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage

from robotteamsim.geometry import Pose, PoseReading

TOLERANCE = rospy.Duration(0, 100_000_000)
"""amcl's transforms are for this much later than their scans."""
TIMEOUT = rospy.Duration(60)


class Localiser:
    """Publishes map -> odom with each scan, so that the robot starts at its initial pose."""

    def __init__(self) -> None:
        weights = [rospy.get_param(f"~laser_z_{name}") for name in ("hit", "short", "max", "rand")]
        assert abs(sum(weights) - 1.0) < 1e-9, weights
        assert rospy.get_param("~laser_model_type") == "beam"
        assert rospy.get_param("~recovery_alpha_slow") == rospy.get_param("~recovery_alpha_fast") == 0.0
        self.odom_frame, self.base_frame = (rospy.get_param(f"~{name}_frame_id") for name in ("odom", "base"))
        error = map(float, os.environ.get("WRONG_START", "0 0 0").split())
        self.start = Pose(*(rospy.get_param(f"~initial_pose_{axis}") for axis in "xya")) @ Pose(*error)
        self.map_T_odom: Pose | None = None
        rospy.wait_for_service("static_map", 60.0)
        assert rospy.ServiceProxy("static_map", GetMap)().map.header.frame_id == "map"
        self.transforms = tf2_ros.Buffer()
        self.listener = tf2_ros.TransformListener(self.transforms)
        self.publisher = rospy.Publisher("/tf", TFMessage, queue_size=10)
        rospy.Subscriber("scan", LaserScan, self.locate)

    def locate(self, scan: LaserScan) -> None:
        """Publish the transform."""
        if self.map_T_odom is None:
            found = self.transforms.lookup_transform(self.odom_frame, self.base_frame, scan.header.stamp, TIMEOUT)
            place, turn = found.transform.translation, found.transform.rotation
            self.map_T_odom = self.start @ PoseReading(place.x, place.y, turn.z, turn.w).pose.inverse()
        reading, link = PoseReading.from_pose(self.map_T_odom), TransformStamped()
        link.header.stamp, link.header.frame_id = scan.header.stamp + TOLERANCE, "map"
        link.child_frame_id = self.odom_frame
        link.transform.translation.x, link.transform.translation.y = reading.x_m, reading.y_m
        link.transform.rotation.z, link.transform.rotation.w = reading.qz, reading.qw
        self.publisher.publish(TFMessage([link]))


if __name__ == "__main__":
    rospy.init_node("amcl")
    localiser = Localiser()
    rospy.spin()
