#!/usr/bin/env python3
"""Locates two robots by tf, as amcl does, first one, then both; loses one for a while, and finds it again."""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions tell the values

from __future__ import annotations

import threading
import unittest
from typing import Any

import numpy as np
import rosgraph
import rospy
import rostest
from geometry_msgs.msg import TransformStamped, Twist, TwistStamped
from listening import Topic, call, make_step, pause, speed_mps
from nav_msgs.msg import Odometry
from robotteamsim.msg import ControllerStatus, MissionEvent, MissionStatus, Voice
from rosgraph_msgs.msg import Log
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

from robotteamsim.geometry import Pose
from robotteamsim.recording.topics.robots import read_odometry

ROBOTS = range(2)
LOST = 1
OFFSET_M = 0.2
"""Error of the localisation to the east, by which its positions differ from the true ones."""
TIMEOUT_S = 0.5
"""`control.tf_timeout_s` of the launch."""
STEP_S = 0.1
BRAKE_MPS2, BRAKE_RADPS2 = 2.0, 8.0
"""Limits of the robots, which are the default ones."""


def stamp_s(message: Any) -> float:
    return message.header.stamp.to_sec()


def pose_of(message: Odometry) -> Pose:
    return read_odometry(message).pose.pose


def moves(message: Odometry) -> bool:
    return speed_mps(message) > 0.2


def stands(message: Odometry) -> bool:
    return abs(speed_mps(message)) < 1e-3 and abs(message.twist.twist.angular.z) < 1e-3


class Localiser:
    """Publishes map -> odom of one robot with each odometry, while it is on."""

    def __init__(self, robot_id: int, output: rospy.Publisher) -> None:
        self.is_on = False
        self.last_s = 0.0
        self._odom = f"robot_{robot_id}/odom"
        self._output = output
        # Each topic arrives in its own thread, so either message of a step may be the first.
        self._first: dict[int, tuple[str, Odometry]] = {}
        self._lock = threading.Lock()
        for name in (f"/hidden/robot_{robot_id}", f"/{self._odom}"):
            rospy.Subscriber(name, Odometry, self._put, name, tcp_nodelay=True)

    def _put(self, message: Odometry, name: str) -> None:
        with self._lock:
            first = self._first.pop(stamp_ns := message.header.stamp.to_nsec(), None)
            if first is None:
                self._first[stamp_ns] = name, message
            elif self.is_on:
                both = dict([first, (name, message)])
                self._locate(both.pop(f"/{self._odom}"), *both.values())

    def _locate(self, odometry: Odometry, truth: Odometry) -> None:
        map_T_odom = Pose(OFFSET_M, 0.0, 0.0) @ pose_of(truth) @ pose_of(odometry).inverse()  # noqa: N806
        link = TransformStamped(odometry.header, self._odom, None)
        link.header.frame_id = "map"
        link.transform = TransformStamped().transform
        link.transform.translation.x, link.transform.translation.y = map_T_odom.x_m, map_T_odom.y_m
        half_rad = 0.5 * map_T_odom.yaw_rad
        link.transform.rotation.z, link.transform.rotation.w = np.sin(half_rad), np.cos(half_rad)
        self._output.publish(TFMessage([link]))
        self.last_s = stamp_s(odometry)


class LocalisedTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        rospy.init_node("localised_test", disable_rostime=True)
        cls.log = Topic("/rosout", Log)
        cls.truths = [Topic(f"/hidden/robot_{i}", Odometry) for i in ROBOTS]
        cls.statuses = [Topic(f"/robot_{i}/controller/status", ControllerStatus) for i in ROBOTS]
        cls.voice = Topic("/robot_0/voice", Voice)
        cls.commands = Topic(f"/robot_{LOST}/cmd_vel", Twist)
        cls.answers = Topic(f"/robot_{LOST}/cmd_vel_stamped", TwistStamped)
        cls.events = Topic("/mission/events", MissionEvent)
        cls.mission = Topic("/mission/status", MissionStatus)
        cls.scene = Topic("/scene/robots", MarkerArray)
        output = rospy.Publisher("/tf", TFMessage, queue_size=0)
        localisers = [Localiser(i, output) for i in ROBOTS]
        cls.run_mission(localisers)

    @classmethod
    def run_mission(cls, localisers: list[Localiser]) -> None:
        """Locate one robot, both, lose one, find it, and wait for the end."""
        localisers[0].is_on = True
        cls.log.wait_for_after(0, lambda line: line.msg.startswith("/tf: waited"), "a report")
        cls.before = [len(truth.messages) for truth in cls.truths]
        localisers[LOST].is_on = True
        for truth in cls.truths:
            truth.wait_for_after(0, moves, "a robot that moves")
        cls.truths[LOST].wait_for(moves, "a robot that moves")
        pause(cls.truths[LOST], cls.answers, cls.statuses[LOST])
        for _ in range(5):  # until the controller is up to date
            cls.step()
        localisers[LOST].is_on = False
        steps = iter(cls.step, None)
        cls.braked = next(truth for truth in steps if cls.statuses[LOST].messages[-1].fault)
        cls.answer = cls.answers.messages[-1]
        cls.stopped = cls.braked if stands(cls.braked) else next(filter(stands, steps))
        cls.lost_s = localisers[LOST].last_s
        call("/simulation/resume", Trigger)
        cls.fault = cls.statuses[LOST].wait_for_after(0, lambda status: bool(status.fault), "a fault").fault
        cls.truths[0].wait_for(moves, "the other robot, which moves")
        cls.events.wait_for_after(0, lambda event: event.kind == "controller_failed", "a stopped robot")
        localisers[LOST].is_on = True
        cls.found_again = cls.truths[LOST].wait_for(moves, "a robot that moves again")
        cls.end = cls.mission.wait_for_after(0, lambda status: status.state == "ended", "state ended")

    @classmethod
    def step(cls) -> Odometry:
        """Take one step, and wait for the command of the robot that is lost; return where it is after the step.

        The world waits meanwhile, so that the time to stop does not depend on the machine.
        """
        num_commands = len(cls.commands.messages)
        make_step(cls.truths[LOST], cls.answers, cls.statuses[LOST])
        cls.commands.wait_for_count(num_commands + 1)
        return cls.truths[LOST].messages[-1]

    def test_nobody_publishes_ground_truth(self) -> None:
        published, _, _ = rosgraph.Master("/localised_test").getSystemState()
        self.assertEqual([name for name, _ in published if "ground_truth" in name], [])

    def test_matrices_are_not_published_where_that_is_switched_off(self) -> None:
        published, _, _ = rosgraph.Master("/localised_test").getSystemState()
        names = [name for name, _ in published]
        self.assertIn("/network/links", names)
        self.assertNotIn("/network/state", names)

    def test_transform_that_does_not_arrive_is_reported_once_with_its_name_and_the_wait(self) -> None:
        lines = [line.msg for line in self.log.messages if line.msg.startswith("/tf: waited")]
        self.assertEqual(len(lines), 1, lines)
        self.assertRegex(lines[0], r"^/tf: waited 10 s for map -> robot_1/base_link; expected ")

    def test_robots_wait_until_all_are_located(self) -> None:
        for truth, count in zip(self.truths, self.before, strict=True):
            self.assertGreater(count, 0)
            self.assertTrue(all(map(stands, truth.messages[:count])))

    def test_robot_without_tf_is_braked_at_the_timeout(self) -> None:
        self.assertAlmostEqual(stamp_s(self.braked) - self.lost_s, TIMEOUT_S, delta=1e-6)
        self.assertEqual((self.answer.header.stamp, self.answer.twist), (self.braked.header.stamp, Twist()))

    def test_braked_robot_stands_as_soon_as_its_drive_can(self) -> None:
        speed = self.braked.twist.twist
        braking_s = max(abs(speed.linear.x) / BRAKE_MPS2, abs(speed.angular.z) / BRAKE_RADPS2)
        # The command arrives one step later, or two, and the last step of braking still has a mean velocity.
        self.assertLessEqual(stamp_s(self.stopped) - stamp_s(self.braked), braking_s + 3 * STEP_S)

    def test_lost_robot_is_reported_by_status_and_event(self) -> None:
        reason = "/tf: no transform map -> robot_1/base_link for 0.5 s (control.tf_timeout_s)"
        self.assertEqual(self.fault, reason)
        failed = [event for event in self.events.messages if event.kind == "controller_failed"]
        self.assertIn((LOST, f"robot 1 is stopped: {reason}"), [(event.robot_id, event.detail) for event in failed])

    def test_robot_drives_again_when_its_tf_is_back(self) -> None:
        self.assertTrue(moves(self.found_again))

    def test_environment_takes_positions_from_tf(self) -> None:
        # A robot that hears nothing is its own local best.
        truths = {stamp_s(truth): pose_of(truth) for truth in self.truths[0].messages}
        errors_m = [
            (voice.local_best.x - truth.x_m, voice.local_best.y - truth.y_m)
            for voice in self.voice.messages
            if not voice.heard and (truth := truths.get(stamp_s(voice))) is not None
        ]
        self.assertGreater(len(errors_m), 20)
        # A transform may be one or two steps old.
        np.testing.assert_allclose(np.median(errors_m, axis=0), (OFFSET_M, 0.0), atol=0.1)

    def test_scene_draws_both_robots(self) -> None:
        drawn = {marker.id for message in self.scene.messages for marker in message.markers if marker.ns == "bodies"}
        self.assertEqual(drawn, set(ROBOTS))

    def test_mission_explores_its_area(self) -> None:
        self.assertEqual(self.end.end, "areas_explored")
        self.events.wait_for_after(0, lambda event: event.kind == "area_explored", "an explored area")
        explored = [event.subject for event in self.events.messages if event.kind == "area_explored"]
        self.assertEqual(explored, ["area_1"])


if __name__ == "__main__":
    rostest.rosrun("robotteamsim", "localised", LocalisedTest)
