#!/usr/bin/env python3
"""Looks at a run from outside: topics, types, frames, stamps, rates, services."""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions tell the values

from __future__ import annotations

import itertools
import math
import unittest
from collections.abc import Iterable
from typing import Any

import rosgraph
import rospy
import rosservice
import rostest
from listening import Topic, call, place_m
from nav_msgs.msg import OccupancyGrid, Odometry
from nav_msgs.srv import GetMap
from robotteamsim.msg import Areas, FloatMap, MissionStatus, NetworkLinks, NetworkMessages, NetworkState, Victims, Voice
from robotteamsim.srv import GetRadioMap
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage

from robotteamsim.geometry import Pose, PoseReading
from robotteamsim.recording.topics import ROBOT_TOPICS, TEAM_TOPICS
from robotteamsim.scenario import load

ROBOTS = ("robot_0", "robot_1")
STEPS = 30
STEP_NS = 100_000_000
SERVICES = {
    "/static_map": "nav_msgs/GetMap",
    "/reset_positions": "std_srvs/Empty",
    "/simulation/pause": "std_srvs/Trigger",
    "/simulation/resume": "std_srvs/Trigger",
    "/simulation/reset": "std_srvs/Trigger",
    "/simulation/reset_seed": "robotteamsim/ResetSeed",
    "/simulation/set_speed": "robotteamsim/SetSpeed",
    "/simulation/set_pose": "robotteamsim/SetPose",
    "/simulation/step": "robotteamsim/Step",
    "/simulation/get_radio_map": "robotteamsim/GetRadioMap",
    "/simulation/set_door": "robotteamsim/SetDoor",
    "/simulation/set_noise": "robotteamsim/SetNoise",
    "/simulation/set_victim": "robotteamsim/SetVictim",
    "/mission/start": "std_srvs/Trigger",
    "/mission/pause": "std_srvs/Trigger",
    "/mission/resume": "std_srvs/Trigger",
    "/mission/abort": "std_srvs/Trigger",
}


def stamps_ns(messages: Iterable[Any]) -> list[int]:
    return [message.header.stamp.to_nsec() for message in messages]


class InterfaceTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        rospy.init_node("interface_test", disable_rostime=True)
        cls.clock = Topic("/clock", Clock)
        cls.tf = Topic("/tf", TFMessage)
        cls.odom = {name: Topic(f"/{name}/odom", Odometry) for name in ROBOTS}
        cls.scan = {name: Topic(f"/{name}/base_scan", LaserScan) for name in ROBOTS}
        cls.truth = {name: Topic(f"/{name}/base_pose_ground_truth", Odometry) for name in ROBOTS}
        cls.voice = Topic("/robot_1/voice", Voice)
        cls.received = Topic("/robot_1/network/rx", NetworkMessages)
        cls.network = Topic("/network/state", NetworkState)
        cls.links = Topic("/network/links", NetworkLinks)
        cls.status = Topic("/mission/status", MissionStatus)
        cls.map = Topic("/map", OccupancyGrid)
        cls.voice_picture = Topic("/voice_map", OccupancyGrid)
        cls.voice_map = Topic("/voice_map/values", FloatMap)
        cls.areas = Topic("/mission/areas", Areas)
        cls.victims = Topic("/mission/victims", Victims)
        for topic in (cls.tf, *cls.odom.values(), *cls.scan.values(), *cls.truth.values()):
            topic.wait_for_count(STEPS)
        cls.status.wait_for_count(STEPS)

    def test_topics_have_their_types(self) -> None:
        published = dict(rospy.get_published_topics())
        scenario = load("garage_sar")
        expected = {topic.name: topic.type_name for topic in TEAM_TOPICS if topic.is_in(scenario)}
        for topic in TEAM_TOPICS:
            self.assertEqual(topic.name in published, topic.is_in(scenario))
        for name in ROBOTS:
            expected |= {f"/{name}/{topic.name}": topic.type_name for topic in ROBOT_TOPICS if topic.is_in(scenario)}
        self.assertEqual({name: published.get(name) for name in expected}, expected)

    def test_services_have_their_types(self) -> None:
        self.assertEqual({name: rosservice.get_service_type(name) for name in SERVICES}, SERVICES)

    def test_world_listens_to_cmd_vel_of_each_robot(self) -> None:
        _, subscribers, _ = rosgraph.Master("/interface_test").getSystemState()
        listeners = dict(subscribers)
        for name in ROBOTS:
            self.assertIn("/simulation", listeners[f"/{name}/cmd_vel"])

    def test_frames_have_no_leading_slash(self) -> None:
        for name in ROBOTS:
            odom, truth, scan = (topic[name].messages[0] for topic in (self.odom, self.truth, self.scan))
            self.assertEqual((odom.header.frame_id, odom.child_frame_id), (f"{name}/odom", f"{name}/base_footprint"))
            self.assertEqual((truth.header.frame_id, truth.child_frame_id), ("map", f"{name}/base_footprint"))
            self.assertEqual(scan.header.frame_id, f"{name}/base_laser_link")
        self.assertEqual(self.map.wait_for_count(1)[0].header.frame_id, "map")

    def test_one_tf_message_a_step_holds_all_links_with_one_stamp(self) -> None:
        chain = [("odom", "base_footprint"), ("base_footprint", "base_link"), ("base_link", "base_laser_link")]
        links = []
        for name in ROBOTS:
            links += [("map", f"{name}/odom"), *((f"{name}/{parent}", f"{name}/{child}") for parent, child in chain)]
        for message in self.tf.messages:
            self.assertEqual([(link.header.frame_id, link.child_frame_id) for link in message.transforms], links)
            self.assertEqual(len(set(stamps_ns(message.transforms))), 1)
        self.assert_every_step_once([message.transforms[0].header.stamp.to_nsec() for message in self.tf.messages])

    def test_map_and_odometry_give_the_true_place(self) -> None:
        link = {link.child_frame_id: link for link in self.tf.messages[-1].transforms}

        def pose(child: str) -> Pose:
            transform = link[child].transform
            place, turn = transform.translation, transform.rotation
            return PoseReading(place.x, place.y, turn.z, turn.w).pose

        there = pose("robot_1/odom") @ pose("robot_1/base_footprint")
        stamp = link["robot_1/odom"].header.stamp
        truth = self.truth["robot_1"].wait_for_after(0, lambda message: message.header.stamp == stamp, f"stamp {stamp}")
        self.assertAlmostEqual(there.x_m, place_m(truth)[0], places=9)
        self.assertAlmostEqual(there.y_m, place_m(truth)[1], places=9)

    def test_world_publishes_every_step_once_with_one_stamp(self) -> None:
        for topic in (*self.odom.values(), *self.scan.values(), *self.truth.values()):
            self.assert_every_step_once(stamps_ns(topic.messages))

    def test_others_answer_with_the_stamps_of_the_world(self) -> None:
        # Out of lockstep they may leave a step out on a busy machine.
        for topic in (self.voice, self.received, self.network, self.links, self.status):
            stamps = stamps_ns(topic.messages)
            self.assertEqual(stamps, sorted(set(stamps)))
            self.assertEqual({stamp % STEP_NS for stamp in stamps}, {0})

    def assert_every_step_once(self, stamps: list[int]) -> None:
        self.assertGreaterEqual(len(stamps), STEPS // 2)
        self.assertEqual(stamps, list(range(stamps[0], stamps[-1] + 1, STEP_NS)))
        self.assertEqual(stamps[0] % STEP_NS, 0)

    def test_clock_ticks_fifty_times_a_second_and_began_at_zero(self) -> None:
        ticks = [message.clock.to_nsec() for message in self.clock.messages]
        self.assertLess(ticks[0], 120 * 10**9)
        self.assertEqual({later - earlier for earlier, later in itertools.pairwise(ticks[1:])}, {20_000_000})

    def test_scan_is_whole_and_shows_no_return_as_range_max(self) -> None:
        for scan in self.scan["robot_0"].messages:
            self.assertEqual(len(scan.ranges), 181)
            self.assertTrue(all(0.0 < distance <= scan.range_max for distance in scan.ranges))
            self.assertAlmostEqual(scan.angle_min + 180 * scan.angle_increment, scan.angle_max, places=5)

    def test_map_is_latched_and_served(self) -> None:
        latched = self.map.wait_for_count(1)[0]
        served = call("/static_map", GetMap).map
        self.assertEqual(served.info, latched.info)
        self.assertGreater(served.info.map_load_time.to_sec(), 0.0)
        self.assertEqual(bytes(map(abs, served.data)), bytes(map(abs, latched.data)))
        self.assertEqual(served.info.width * served.info.height, len(served.data))

    def test_voice_map_is_latched_as_picture_and_as_values(self) -> None:
        picture, values = self.voice_picture.wait_for_count(1)[0], self.voice_map.wait_for_count(1)[0]
        self.assertEqual((picture.info.width, picture.info.height), (values.width, values.height))
        self.assertEqual(len(values.data), values.width * values.height)
        self.assertEqual((values.quantity, values.unit), ("voice_level", "dB"))
        self.assertEqual(picture.header.stamp, values.header.stamp)
        self.assertGreater(max(values.data), 20.0)

    def test_radio_maps_are_published_to_subscribers(self) -> None:
        picture, values = Topic("/robot_0/radio_map", OccupancyGrid), Topic("/robot_0/radio_map/values", FloatMap)
        levels = values.next()
        self.assertEqual(
            (levels.quantity, levels.unit, len(levels.data)), ("rssi", "dBm", levels.width * levels.height)
        )
        self.assertLess(max(levels.data), -20.0)
        self.assertGreaterEqual(min(picture.next().data), 0)

    def test_radio_map_of_a_chosen_robot_comes_once_a_second(self) -> None:
        stamps = stamps_ns(Topic("/robot_1/radio_map/values", FloatMap).wait_for_count(5))
        for earlier, later in itertools.pairwise(stamps):
            self.assertGreaterEqual(later - earlier, 10**9)
            self.assertLess(later - earlier, 2 * 10**9)

    def test_radio_map_is_made_on_demand_at_any_resolution(self) -> None:
        coarse, usual = (
            call("/simulation/get_radio_map", GetRadioMap, robot_id=1, resolution_m=side) for side in (1.0, 0.0)
        )
        self.assertEqual((coarse.success, usual.success), (True, True))
        self.assertEqual((coarse.map.resolution_m, usual.map.resolution_m), (1.0, 0.25))
        for made in (coarse.map, usual.map):
            self.assertEqual((made.quantity, made.unit, made.header.frame_id), ("rssi", "dBm", "map"))
            self.assertEqual(len(made.data), made.width * made.height)
            self.assertEqual(made.header.stamp.to_nsec() % STEP_NS, 0)
            self.assertLess(max(made.data), -20.0)
        self.assertGreater(usual.map.width, coarse.map.width)

    def test_invalid_radio_map_is_rejected_with_the_reason(self) -> None:
        for robot_id, resolution_m, reason in (
            (2, 0.0, "robot_id: 2; expected 0 to 1"),
            (-1, 0.0, "robot_id: -1; expected 0 to 1"),
            (0, 0.01, "resolution_m: 0.01; expected 0.05 to 10, or 0"),
            (0, math.nan, "resolution_m: nan; expected 0.05 to 10, or 0"),
        ):
            refused = call("/simulation/get_radio_map", GetRadioMap, robot_id=robot_id, resolution_m=resolution_m)
            self.assertEqual((refused.success, refused.message), (False, reason))

    def test_network_links_two_robots_side_by_side(self) -> None:
        state = self.network.messages[-1]
        self.assertEqual(state.num_robots, 2)
        matrices = (state.rssi_dbm, state.link, state.adjacency, state.hop_count, state.break_matrix, state.endangered)
        self.assertEqual([len(matrix) for matrix in matrices], 6 * [4])
        self.assertEqual(list(state.adjacency), [0, 1, 1, 0])
        self.assertAlmostEqual(state.fiedler_value, 2.0)

    def test_links_of_a_step_are_those_of_its_matrices(self) -> None:
        state = self.network.next()
        links = self.links.wait_for_after(0, lambda message: message.header.stamp == state.header.stamp, "the stamp")
        self.assertEqual((links.num_robots, links.num_links, bytes(links.present)), (2, 1, b"\1\1"))
        self.assertEqual(bytes(links.adjacency), b"\2\1")
        self.assertEqual(bytes(links.endangered), b"\0\0")
        self.assertEqual(links.fiedler_value, state.fiedler_value)

    def test_messages_reach_the_other_robot(self) -> None:
        message = self.received.wait_for_after(0, lambda message: message.messages, "messages")
        self.assertEqual({sent.sender for sent in message.messages}, {0})

    def test_mission_reports_areas_and_victims(self) -> None:
        self.assertEqual(self.status.messages[-1].state, "running")
        self.assertEqual(self.status.messages[-1].scenario, "garage_sar")
        areas, victims = self.areas.wait_for_count(1)[0].areas, self.victims.wait_for_count(1)[0].victims
        self.assertEqual([area.name for area in areas], [f"area_{number}" for number in range(1, 6)])
        self.assertEqual([area.target for area in areas].count(True), 1)
        self.assertEqual({victim.state for victim in victims} - {"waiting", "heard", "saved"}, set())


if __name__ == "__main__":
    rostest.rosrun("robotteamsim", "interface", InterfaceTest)
