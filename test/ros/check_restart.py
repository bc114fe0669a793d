#!/usr/bin/env python3
"""Resets a running mission again and again."""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions tell the values

from __future__ import annotations

import unittest

import rospy
import rostest
from listening import Topic, call, pause, speed_mps
from nav_msgs.msg import Odometry
from robotteamsim.msg import MissionEvent, MissionStatus
from std_srvs.srv import Trigger

RESETS = 3


class RestartTest(unittest.TestCase):
    def test_every_node_starts_again_however_often_it_is_asked(self) -> None:
        rospy.init_node("restart_test", disable_rostime=True)
        truth = Topic("/robot_1/base_pose_ground_truth", Odometry)
        status = Topic("/mission/status", MissionStatus)
        events = Topic("/mission/events", MissionEvent)
        status.wait_for_after(0, lambda message: message.time_s > 10.0, "a mission under way")
        for _ in range(3):
            pause(truth, status)
            begin, next_event = len(status.messages), len(events.messages)
            for _ in range(RESETS):
                self.assertEqual(call("/simulation/reset", Trigger).message, "reset")
            self.assertEqual(call("/simulation/resume", Trigger).message, "resumed")
            fresh = status.wait_for_after(begin, lambda message: message.time_s < 1.0, "a fresh mission")
            self.assertLess(fresh.header.stamp.to_sec(), 5.0)
            status.wait_for_after(begin, lambda message: message.time_s > 5.0, "a mission that goes on")
            truth.wait_for(lambda message: speed_mps(message) > 0.3, "a robot that drives")
            start = events.wait_for_after(next_event, lambda event: event.kind == "start", "a start")
            for _ in range(RESETS):
                next_event, begin = events.messages.index(start, next_event) + 1, len(status.messages)
                self.assertEqual(call("/simulation/reset", Trigger).message, "reset")
                start = events.wait_for_after(next_event, lambda event: event.kind == "start", "another start")
                status.wait_for_after(begin, lambda message: message.time_s < 1.0, "another fresh mission")


if __name__ == "__main__":
    rostest.rosrun("robotteamsim", "restart", RestartTest)
