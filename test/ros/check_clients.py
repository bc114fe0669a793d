#!/usr/bin/env python3
"""Asks of the world what each of Stage's usual clients asks, by the library that it asks by.

By their sources: slam_gmapping (gmapping/src/slam_gmapping.cpp), amcl (amcl_node.cpp), move_base (costmap_2d's
obstacle_layer.cpp), map_server (map_saver.cpp), teleop_twist_keyboard, patrolling_sim (PatrolAgent.cpp).
"""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions tell the values

from __future__ import annotations

import math
import unittest
from typing import Any

import rosgraph
import rospy
import rostest
import tf2_ros
from geometry_msgs.msg import TransformStamped, Twist, Vector3
from listening import Topic, call, drive, place_m, speed_mps
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage

SCANS = 30
TIMEOUT = rospy.Duration(60)
"""[simulated]"""
CACHE = rospy.Duration(3600)
"""A slow test asks for older transforms than a client does."""
FORWARD = Twist(linear=Vector3(0.3, 0.0, 0.0))


def stamp_ns(message: Any) -> int:
    return message.header.stamp.to_nsec()


def yaw_rad(turn: Any) -> float:
    return 2.0 * math.atan2(turn.z, turn.w)


class ClientsTest(unittest.TestCase):
    """The world of `commands.test` publishes no map -> odom: that is for amcl or slam_gmapping to do."""

    @classmethod
    def setUpClass(cls) -> None:
        # Before the node begins: tf2 forgets all transforms when the simulated time of its node jumps back.
        call("/simulation/reset", Trigger)
        # Clients live by the simulated clock.
        rospy.init_node("clients_test")
        cls.transforms = tf2_ros.Buffer(cache_time=CACHE)
        cls.listener = tf2_ros.TransformListener(cls.transforms)
        cls.command = rospy.Publisher("/robot_0/cmd_vel", Twist, queue_size=1)
        cls.tf = Topic("/tf", TFMessage)
        cls.odometry = Topic("/robot_0/odom", Odometry)
        cls.truth = Topic("/robot_0/base_pose_ground_truth", Odometry)
        cls.scan = Topic("/robot_0/base_scan", LaserScan)
        for topic in (cls.tf, cls.odometry, cls.scan):
            topic.wait_for_count(1)
        cls.driven = drive(cls.command, FORWARD, cls.odometry, SCANS)
        cls.scan.wait_for_after(0, lambda scan: stamp_ns(scan) >= stamp_ns(cls.driven[-1]), "the last step's stamp")
        # Scans may come before the first transform.
        first_ns = min(stamp_ns(link) for link in cls.tf.messages[0].transforms)
        cls.scans = [scan for scan in cls.scan.messages if stamp_ns(scan) >= first_ns][:SCANS]
        cls.links = [link for message in cls.tf.messages for link in message.transforms]

    def locate(self, robot_name: str) -> None:
        """Say where odometry is in the map, as amcl does."""
        link = TransformStamped(child_frame_id=f"{robot_name}/odom")
        link.header.frame_id = "map"
        link.transform.translation = Vector3(4.0, 5.0, 0.0)
        link.transform.rotation.w = 1.0
        self.transforms.set_transform_static(link, "amcl")

    def test_slam_gmapping_places_every_scan_in_odom_at_its_stamp(self) -> None:
        odometry = {stamp_ns(message): message for message in self.odometry.messages}
        for scan in self.scans:
            base = self.transforms.lookup_transform("robot_0/odom", "robot_0/base_link", scan.header.stamp, TIMEOUT)
            laser = self.transforms.lookup_transform("robot_0/odom", scan.header.frame_id, scan.header.stamp, TIMEOUT)
            self.assertEqual((base.header.stamp, laser.header.stamp), 2 * (scan.header.stamp,))
            if stamp_ns(scan) in odometry:
                place = base.transform.translation
                self.assertEqual((place.x, place.y), place_m(odometry[stamp_ns(scan)]))

    def test_slam_gmapping_finds_a_level_laser_whose_beams_are_always_the_same(self) -> None:
        form = {
            (len(scan.ranges), scan.angle_min, scan.angle_max, scan.angle_increment, scan.range_min, scan.range_max)
            for scan in self.scans
        }
        self.assertEqual(len(form), 1)
        ((beams, first_rad, last_rad, increment_rad, _, _),) = form
        self.assertEqual(beams, 181)
        self.assertAlmostEqual(first_rad + (beams - 1) * increment_rad, last_rad, places=5)
        turn = self.transforms.lookup_transform(
            "robot_0/base_footprint", self.scans[0].header.frame_id, self.scans[0].header.stamp, TIMEOUT
        ).transform.rotation
        self.assertEqual((turn.x, turn.y), (0.0, 0.0))

    def test_slam_gmapping_and_amcl_alone_say_where_odom_is_in_the_map(self) -> None:
        self.assertEqual({link.child_frame_id for link in self.links if link.header.frame_id == "map"}, set())

    def test_amcl_ties_a_robot_to_the_map_by_its_odom_frame(self) -> None:
        self.locate("robot_0")
        stamp = self.scans[-1].header.stamp
        there = self.transforms.lookup_transform("map", "robot_0/base_laser_link", stamp, TIMEOUT).transform
        odom = self.transforms.lookup_transform("robot_0/odom", "robot_0/base_laser_link", stamp, TIMEOUT).transform
        self.assertAlmostEqual(there.translation.x, 4.0 + odom.translation.x)
        self.assertAlmostEqual(yaw_rad(there.rotation), yaw_rad(odom.rotation))

    def test_move_base_puts_every_scan_into_its_costmap(self) -> None:
        for scan in self.scans:
            # A beam of another time would be looked up at another stamp, and +inf would clear nothing.
            self.assertEqual(scan.time_increment, 0.0)
            self.assertTrue(all(map(math.isfinite, scan.ranges)))
            self.assertLessEqual(max(scan.ranges), scan.range_max)
        height_m = self.transforms.lookup_transform(
            "robot_0/base_footprint", self.scans[0].header.frame_id, self.scans[0].header.stamp, TIMEOUT
        ).transform.translation.z
        self.assertTrue(0.0 < height_m < 2.0)

    def test_move_base_keeps_the_robot_moving_by_commands_at_five_hertz(self) -> None:
        self.assertTrue(all(speed_mps(message) > 0.25 for message in self.driven[SCANS // 2 :]))

    def test_move_base_gets_the_true_twist_with_the_odometry(self) -> None:
        truths = {stamp_ns(message): message for message in self.truth.messages}
        pairs = [(message, truths[stamp_ns(message)]) for message in self.driven if stamp_ns(message) in truths]
        self.assertGreater(len(pairs), SCANS // 2)
        for odometry, truth in pairs:
            self.assertAlmostEqual(speed_mps(odometry), speed_mps(truth), delta=0.1)
        self.assertEqual({message.child_frame_id for message in self.driven}, {"robot_0/base_footprint"})

    def test_patrolling_sim_finds_each_robot_by_its_number(self) -> None:
        published = dict(rospy.get_published_topics())
        _, subscribers, _ = rosgraph.Master(rospy.get_name()).getSystemState()
        for name in ("robot_0", "robot_1"):
            self.locate(name)
            self.assertEqual(published[f"/{name}/odom"], "nav_msgs/Odometry")
            self.assertIn("/simulation", dict(subscribers)[f"/{name}/cmd_vel"])
            self.assertTrue(self.transforms.can_transform("map", f"{name}/base_link", rospy.Time(0), TIMEOUT))


if __name__ == "__main__":
    rostest.rosrun("robotteamsim", "clients", ClientsTest)
