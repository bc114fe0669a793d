#!/usr/bin/env python3
"""Asks of the world what each of Stage's usual clients asks, by the library that it asks by.

By their sources: slam_gmapping (gmapping/src/slam_gmapping.cpp), amcl (amcl_node.cpp), move_base (costmap_2d's
obstacle_layer.cpp), map_server (map_saver.cpp), teleop_twist_keyboard, patrolling_sim (PatrolAgent.cpp).
"""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions tell the values

from __future__ import annotations

import itertools
import math
import unittest
from typing import Any

import rosgraph
import rospy
import rostest
import tf2_ros
from geometry_msgs.msg import TransformStamped, Twist, Vector3
from listening import TIMEOUT_S, Topic, call, drive, place_m, speed_mps
from nav_msgs.msg import OccupancyGrid, Odometry
from nav_msgs.srv import GetMap
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage

SCANS = 30
TICK_NS, STEP_NS = 20_000_000, 100_000_000
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
        call("/reset", Trigger)
        # Clients live by the simulated clock.
        rospy.init_node("clients_test")
        cls.transforms = tf2_ros.Buffer(cache_time=CACHE)
        cls.listener = tf2_ros.TransformListener(cls.transforms)
        cls.command = rospy.Publisher("/robot_0/cmd_vel", Twist, queue_size=1)
        cls.clock = Topic("/clock", Clock)
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

    def test_every_client_gets_time_that_only_goes_on(self) -> None:
        # rospy itself drops ticks that it is too late for; check_interface.py counts them.
        ticks = [message.clock.to_nsec() for message in self.clock.messages]
        self.assertEqual(ticks, sorted(set(ticks)))
        self.assertEqual({tick % TICK_NS for tick in ticks[1:]}, {0})

    def test_every_client_gets_frames_without_a_leading_slash(self) -> None:
        frames = {name for link in self.links for name in (link.header.frame_id, link.child_frame_id)}
        poses = [*self.odometry.messages, *self.truth.messages]
        frames |= {message.header.frame_id for message in (*poses, *self.scans)}
        frames |= {message.child_frame_id for message in poses}
        self.assertEqual({name for name in frames if name.startswith("/")}, set())

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

    def test_every_robot_has_frames_of_its_own(self) -> None:
        frames = [(link.header.frame_id, link.child_frame_id) for link in self.links]
        owners = {tuple(name.split("/")[0] for name in pair) for pair in frames}
        self.assertEqual(owners, {("robot_0", "robot_0"), ("robot_1", "robot_1")})

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

    def test_move_base_never_sees_the_robot_older_than_a_step(self) -> None:
        # Its transform_tolerance is 0.2 to 0.3 s.
        stamps = [message.transforms[0].header.stamp.to_nsec() for message in self.tf.messages]
        self.assertEqual({later - earlier for earlier, later in itertools.pairwise(stamps)}, {STEP_NS})

    def test_map_server_saves_the_map_however_late_it_comes(self) -> None:
        grid = rospy.wait_for_message("/map", OccupancyGrid, TIMEOUT_S)
        self.assertEqual(len(grid.data), grid.info.width * grid.info.height)
        self.assertLessEqual(set(grid.data), {-1, 0, 100})
        self.assertGreater(grid.info.resolution, 0.0)
        turn = grid.info.origin.orientation
        self.assertEqual((turn.x, turn.y, turn.z, turn.w), (0.0, 0.0, 0.0, 1.0))

    def test_amcl_gets_the_map_by_service_as_by_topic(self) -> None:
        served = call("/static_map", GetMap).map
        latched = rospy.wait_for_message("/map", OccupancyGrid, TIMEOUT_S)
        self.assertEqual((served.info, served.data), (latched.info, latched.data))
        self.assertEqual(served.header.frame_id, "map")

    def test_teleop_twist_keyboard_moves_the_robot_by_one_message(self) -> None:
        self.truth.wait_for(lambda message: abs(speed_mps(message)) < 1e-3, "a robot that stands")
        self.command.publish(Twist(linear=Vector3(-0.3, 0.0, 0.0)))
        self.truth.wait_for(lambda message: speed_mps(message) < -0.25, "a robot that moves back")

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
