#!/usr/bin/env python3
"""Hears every topic of many robots, and counts what comes."""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions tell the values

from __future__ import annotations

import time
import unittest
from collections.abc import Sequence
from typing import Any

import rospy
import rostest
from listening import TIMEOUT_S, Topic, call, latched_time
from nav_msgs.msg import Odometry
from robotteamsim.msg import Contact
from robotteamsim.srv import Step
from sensor_msgs.msg import LaserScan
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage

ROBOTS = 30
STEPS = 60
STEP_NS = 100_000_000
TOPICS = {"odom": Odometry, "base_scan": LaserScan, "base_pose_ground_truth": Odometry, "contact": Contact}


class ManyTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        rospy.init_node("many_test", disable_rostime=True)
        call("/simulation/pause", Trigger)
        cls.tf = Topic("/tf", TFMessage)
        cls.topics = [Topic(f"/robot_{i}/{name}", kind) for i in range(ROBOTS) for name, kind in TOPICS.items()]
        deadline_s = time.monotonic() + TIMEOUT_S
        # A publisher may know a subscriber a moment later than the subscriber knows it.
        while any(not topic.messages for topic in (cls.tf, *cls.topics)):
            assert time.monotonic() < deadline_s, "not all topics are published"
            call("/simulation/step", Step, steps=1)
        stamp = latched_time()
        for topic in cls.topics:
            topic.wait_for_step(stamp)
        cls.begin = {topic.name: len(topic.messages) for topic in (cls.tf, *cls.topics)}
        call("/simulation/step", Step, steps=STEPS)

    def test_every_step_of_every_topic_arrives_once_and_in_order(self) -> None:
        first_ns = self.new_messages(self.topics[0])[0].header.stamp.to_nsec()
        wanted_ns = [first_ns + index * STEP_NS for index in range(STEPS)]
        for topic in self.topics:
            messages = self.new_messages(topic)
            self.assertEqual([message.header.stamp.to_nsec() for message in messages], wanted_ns, topic.name)
            numbers = [message.header.seq for message in messages]
            self.assertEqual(numbers, list(range(numbers[0], numbers[0] + STEPS)), topic.name)

    def new_messages(self, topic: Topic) -> Sequence[Any]:
        begin = self.begin[topic.name]
        return topic.wait_for_count(begin + STEPS)[begin:]

    def test_one_tf_message_a_step_has_the_frames_of_all_robots(self) -> None:
        messages = self.new_messages(self.tf)
        self.assertEqual(len(messages), STEPS)
        for message in messages:
            self.assertEqual(len({link.child_frame_id for link in message.transforms}), 3 * ROBOTS)
            self.assertEqual(len({link.header.stamp.to_nsec() for link in message.transforms}), 1)


if __name__ == "__main__":
    rostest.rosrun("robotteamsim", "many", ManyTest)
