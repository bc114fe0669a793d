#!/usr/bin/env python3
"""Drives one robot by hand while the others go on, and stops another one's controller for a while."""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions tell the values

from __future__ import annotations

import os
import signal
import unittest
from xmlrpc.client import ServerProxy

import rosgraph
import rospy
import rostest
from geometry_msgs.msg import Twist, Vector3
from listening import Topic, speed_mps
from nav_msgs.msg import Odometry
from robotteamsim.msg import MissionEvent
from rosgraph_msgs.msg import Log


def moves(message: Odometry) -> bool:
    return speed_mps(message) > 0.2


def stands(message: Odometry) -> bool:
    return abs(speed_mps(message)) < 1e-3 and abs(message.twist.twist.angular.z) < 1e-3


class DrivingTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        rospy.init_node("driving_test", disable_rostime=True)
        cls.master = rosgraph.Master("/driving_test")
        cls.command = rospy.Publisher("/robot_0/cmd_vel", Twist, queue_size=0)
        cls.truths = [Topic(f"/robot_{robot_id}/base_pose_ground_truth", Odometry) for robot_id in range(3)]
        cls.log = Topic("/rosout", Log)
        cls.events = Topic("/mission/events", MissionEvent)
        for truth in cls.truths[1:]:
            truth.wait_for_after(0, moves, "a robot that moves")

    def test_robot_is_driven_by_hand_while_the_others_go_on(self) -> None:
        self.assertTrue(all(map(stands, self.truths[0].messages)))
        publishers = dict(self.master.getSystemState()[0])
        self.assertEqual(publishers["/robot_0/cmd_vel"], [rospy.get_name()])
        self.assertEqual(publishers["/robot_1/cmd_vel"], ["/robot_1/controller"])
        begin = len(self.truths[0].messages)
        self.command.publish(Twist(linear=Vector3(-0.3, 0.0, 0.0)))
        self.truths[0].wait_for_after(begin, lambda message: speed_mps(message) < -0.29, "a robot that moves back")
        self.truths[0].wait_for(stands, "a robot that stands again")
        for truth in self.truths[1:]:
            truth.wait_for(moves, "a robot that moves")

    def test_robot_whose_controller_is_silent_is_reported_and_stopped_until_it_speaks_again(self) -> None:
        controller = ServerProxy(self.master.lookupNode("/robot_1/controller"))
        _, _, pid = controller.getPid("/driving_test")
        begin, first = len(self.log.messages), len(self.events.messages)
        os.kill(pid, signal.SIGSTOP)
        try:
            report = self.log.wait_for_after(
                begin,
                lambda message: message.name == "/simulation" and "/robot_1/cmd_vel_stamped" in message.msg,
                "a report",
            )
            self.assertIn("silent", report.msg)
            failed = self.events.wait_for_after(
                first, lambda event: (event.kind, event.robot_id) == ("controller_failed", 1), "an event"
            )
            # A signal between two messages of a step leaves others of its topics silent first.
            self.assertRegex(failed.detail, "^robot 1 is stopped: .*/robot_1/.*: silent for 1 s$")
            self.truths[1].wait_for(stands, "a robot that stands")
            index = len(self.truths[1].messages)
            self.truths[2].wait_for(moves, "a robot that moves")
            self.truths[1].wait_for_count(index + 20)
            self.assertTrue(all(map(stands, self.truths[1].messages[index : index + 20])))
        finally:
            os.kill(pid, signal.SIGCONT)
        self.truths[1].wait_for(moves, "a robot that moves again")


if __name__ == "__main__":
    rostest.rosrun("robotteamsim", "driving", DrivingTest)
