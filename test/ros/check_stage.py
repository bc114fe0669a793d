#!/usr/bin/env python3
"""Checks that clients written for stage_ros find its names, its rates and its requests."""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions show the values

from __future__ import annotations

import itertools
import time
import unittest
from typing import Any

import numpy as np
import rospy
import rostest
import shapely
import tf2_ros
from geometry_msgs.msg import Twist, Vector3
from listening import TIMEOUT_S, Topic, drive, speed_mps
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from robotteamsim.geometry import Pose
from robotteamsim.recording.topics.robots import read_odometry
from robotteamsim.scenario import load
from robotteamsim.scenario.plan import obstacles

TICK_NS, STEP_NS = 20_000_000, 100_000_000
SHIFTS_NS = (-STEP_NS, 0, STEP_NS)
SCANS = 20
TIMEOUT = rospy.Duration(60)
"""[simulated]"""
FORWARD = Twist(linear=Vector3(0.3, 0.0, 0.0))


def ranges_m(solid: shapely.Geometry, laser: Pose, scan: LaserScan, turn_rad: float) -> np.ndarray:
    """Return what a scan would have at a pose of the laser that is turned a little, by exact intersections."""
    at = np.array([laser.x_m, laser.y_m])
    angles = laser.yaw_rad + turn_rad + scan.angle_min + scan.angle_increment * np.arange(len(scan.ranges))
    ends = at + scan.range_max * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    rays = shapely.linestrings(np.stack([np.broadcast_to(at, ends.shape), ends], axis=1))
    return np.fmin(shapely.distance(shapely.intersection(solid, rays), shapely.Point(at)), scan.range_max)


def stamps_ns(messages: Any) -> list[int]:
    return [message.header.stamp.to_nsec() for message in messages]


class StageTest(unittest.TestCase):
    """One robot that drives through the arena."""

    @classmethod
    def setUpClass(cls) -> None:
        rospy.init_node("stage_test")
        cls.transforms = tf2_ros.Buffer(cache_time=rospy.Duration(3600))
        cls.listener = tf2_ros.TransformListener(cls.transforms)
        cls.command = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
        cls.requests = rospy.Publisher("/stageGUIRequest", String, queue_size=5)
        cls.clock = Topic("/clock", Clock)
        cls.tf = Topic("/tf", TFMessage)
        cls.odometry = Topic("/odom", Odometry)
        cls.scan = Topic("/base_scan", LaserScan)
        cls.truth = Topic("/base_pose_ground_truth", Odometry)
        for topic in (cls.tf, cls.odometry, cls.scan, cls.truth):
            topic.wait_for_count(1)
        cls.driven = drive(cls.command, FORWARD, cls.odometry, 5 * SCANS)
        cls.scans = cls.scan.wait_for_count(SCANS)

    def test_command_without_a_prefix_drives_the_robot(self) -> None:
        self.assertGreater(speed_mps(self.driven[-1]), 0.25)

    def test_odometry_comes_with_each_tick_and_scans_with_each_step(self) -> None:
        for topic, period_ns in ((self.odometry, TICK_NS), (self.scan, STEP_NS)):
            stamps = stamps_ns(topic.messages)
            self.assertEqual({after - before for before, after in itertools.pairwise(stamps)}, {period_ns})

    def test_tf_has_the_pose_of_each_odometry_message(self) -> None:
        stamps = {link.header.stamp.to_nsec() for message in self.tf.messages for link in message.transforms}
        common = [message for message in self.odometry.messages if message.header.stamp.to_nsec() in stamps]
        self.assertGreater(len(common), 4 * SCANS)
        for message in common:
            place = self.transforms.lookup_transform("odom", "base_footprint", message.header.stamp, TIMEOUT)
            self.assertEqual(place.transform.translation.x, message.pose.pose.position.x)

    def test_scan_has_the_distances_of_the_walls_at_the_pose_of_its_stamp(self) -> None:
        solid = obstacles(load("tutorial_arena").plan)
        truths = {message.header.stamp.to_nsec(): read_odometry(message) for message in self.truth.messages}
        scans = [
            scan for scan in self.scan.messages if {scan.header.stamp.to_nsec() + d for d in SHIFTS_NS} <= truths.keys()
        ]
        moving = [scan for scan in scans if truths[scan.header.stamp.to_nsec()].twist.linear_x_mps > 0.25]
        self.assertGreater(len(moving), SCANS // 2)
        # Just beside an edge ranges jump, so a beam may see either side of its angle.
        for scan in moving:
            seen = [ranges_m(solid, self.laser_at(truths, scan, 0), scan, turn) for turn in (-1e-6, 0.0, 1e-6)]
            self.assertTrue((np.array(scan.ranges) >= np.min(seen, axis=0) - 1e-4).all())
            self.assertTrue((np.array(scan.ranges) <= np.max(seen, axis=0) + 1e-4).all())
        for shift_ns in (-STEP_NS, STEP_NS):
            wrong = [ranges_m(solid, self.laser_at(truths, scan, shift_ns), scan, 0.0) for scan in moving]
            off_m = np.abs(np.array([scan.ranges for scan in moving]) - wrong).max(axis=1)
            self.assertGreater(off_m.min(), 0.02)  # a step is 0.03 m

    def laser_at(self, truths: dict[int, Any], scan: LaserScan, shift_ns: int) -> Pose:
        link = self.transforms.lookup_transform("base_footprint", scan.header.frame_id, scan.header.stamp, TIMEOUT)
        mount, turn = link.transform.translation, link.transform.rotation
        pose: Pose = truths[scan.header.stamp.to_nsec() + shift_ns].pose.pose
        return pose @ Pose(mount.x, mount.y, 2.0 * np.arctan2(turn.z, turn.w))

    def test_odometry_goes_on_evenly_between_two_steps(self) -> None:
        ways_m = [message.pose.pose.position.x for message in self.driven[-2 * SCANS :]]
        steps_m = [after - before for before, after in itertools.pairwise(ways_m)]
        self.assertLess(max(steps_m), 2.0 * max(min(steps_m), 1e-3))

    def test_frames_have_no_prefix(self) -> None:
        names = {name for message in self.tf.messages for link in message.transforms for name in self.pair(link)}
        self.assertEqual(names, {"odom", "base_footprint", "base_link", "base_laser_link"})
        self.assertEqual(self.scans[0].header.frame_id, "base_laser_link")
        self.assertEqual(self.odometry.messages[0].child_frame_id, "base_footprint")

    @staticmethod
    def pair(link: Any) -> tuple[str, str]:
        return link.header.frame_id, link.child_frame_id

    def test_speedup_is_followed_and_footprints_are_ignored(self) -> None:
        deadline_s = time.monotonic() + TIMEOUT_S
        while not self.requests.get_num_connections() and time.monotonic() < deadline_s:
            rospy.rostime.wallsleep(0.05)
        self.requests.publish("footprints")
        self.requests.publish("speedup_0.5")
        while time.monotonic() < deadline_s and self.wall_s_of_one_second() < 1.8:
            pass
        self.assertGreater(self.wall_s_of_one_second(), 1.8)

    def wall_s_of_one_second(self) -> float:
        start = self.clock.next().clock
        start_s = time.monotonic()
        self.clock.wait_for(lambda message: (message.clock - start).to_sec() >= 1.0, "one second more")
        return time.monotonic() - start_s


if __name__ == "__main__":
    rostest.rosrun("robotteamsim", "stage", StageTest)
