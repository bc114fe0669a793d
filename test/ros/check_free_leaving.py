#!/usr/bin/env python3
"""Takes robots off the floor and puts them back while all nodes run as they come."""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions tell the values

from __future__ import annotations

import unittest

import rospy
import rostest
from geometry_msgs.msg import Pose2D
from listening import Topic, call, pause, place_m, speed_mps
from nav_msgs.msg import Odometry
from robotteamsim.msg import MissionStatus, NetworkState
from robotteamsim.srv import RemoveRobot, SpawnRobot
from std_srvs.srv import Trigger

ROBOTS = range(3)


def has_row(robot_id: int, there: bool) -> object:
    """Return whether a network's state has a robot among those who are there."""
    return lambda message: (message.hop_count[robot_id * message.num_robots + robot_id] == 0) == there


class FreeLeavingTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        rospy.init_node("free_leaving_test", disable_rostime=True)
        cls.truths = [Topic(f"/robot_{i}/base_pose_ground_truth", Odometry) for i in ROBOTS]
        cls.network = Topic("/network/state", NetworkState)
        cls.status = Topic("/mission/status", MissionStatus)
        cls.status.wait_for(lambda message: message.state == "running", "state running")

    def test_others_go_on_without_a_robot_that_left_and_with_it_when_it_came(self) -> None:
        pause(self.truths[1])
        silent_since = len(self.truths[1].messages)
        self.assertTrue(call("/simulation/remove_robot", RemoveRobot, robot_id=1).success)
        self.assertTrue(call("/simulation/resume", Trigger).success)
        self.network.wait_for(has_row(1, there=False), "robot 1 gone")
        before = self.status.next().time_s
        self.status.wait_for(lambda message: message.time_s > before + 3.0, "3 s more of the mission")
        self.truths[0].wait_for(lambda message: abs(speed_mps(message)) > 0.1, "robot 0 driving")
        self.assertEqual(len(self.truths[1].messages), silent_since)
        place = Pose2D(10.0, 3.0, 0.5)
        self.assertTrue(call("/simulation/spawn_robot", SpawnRobot, robot_id=1, pose=place).success)
        self.network.wait_for(has_row(1, there=True), "robot 1 there")
        arrived = self.truths[1].wait_for_after(silent_since, lambda _: True, "robot 1")
        self.assertEqual(place_m(arrived), (10.0, 3.0))
        self.truths[1].wait_for(lambda message: abs(speed_mps(message)) > 0.1, "robot 1 driving")

    def test_z_mission_ends_when_nobody_is_left(self) -> None:
        for robot_id in ROBOTS:
            self.assertTrue(call("/simulation/remove_robot", RemoveRobot, robot_id=robot_id).success)
        ended = self.status.wait_for(lambda message: message.state == "ended", "state ended")
        self.assertEqual(ended.end, "none_left")


if __name__ == "__main__":
    rostest.rosrun("robotteamsim", "free_leaving", FreeLeavingTest)
