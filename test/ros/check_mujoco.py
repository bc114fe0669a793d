#!/usr/bin/env python3
"""Compares a mission in the world of MuJoCo, in lockstep, with the same mission run without ROS."""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions tell the values

from __future__ import annotations

import json
import math
import os
import unittest
from pathlib import Path

import rospy
import rostest
from geometry_msgs.msg import Pose2D
from listening import Topic, call, make_step, pause
from robotteamsim.msg import MissionStatus, Robots
from robotteamsim.srv import DropObject, LiftObject, SetObject, SetPose

from robotteamsim.scenario import Scenario, load
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation

FOLDER = Path(os.environ["ROSTEST_OUT"])


class MujocoTest(unittest.TestCase):
    def test_mission_and_mishaps_are_those_without_ros(self) -> None:
        rospy.init_node("mujoco_test", disable_rostime=True)
        robots, status = Topic("/world/robots", Robots), Topic("/mission/status", MissionStatus)
        status.wait_for_after(0, lambda message: message.state == "ended", "state ended")
        document = json.loads((FOLDER / "mission.json").read_text(encoding="utf-8"))
        found = document["result"]
        settings = rospy.get_param("/robotteamsim/set").split()
        simulation = Simulation(load("garage_sar", [*settings, "run.seed=7"]))
        expected = simulation.run()
        self.assertEqual((found["trajectory_hash"], found["steps"]), (expected.trajectory_hash, expected.steps))
        tipped = [robot_id for robot_id, mishap in simulation.world.mishaps.items() if mishap == "tipped_over"]
        self.assertNotEqual(tipped, [])
        last = robots.wait_for_after(0, lambda message: sum(message.mishaps) == len(tipped), "all mishaps")
        self.assertEqual([i for i, mishap in enumerate(last.mishaps) if mishap == Robots.TIPPED_OVER], tipped)
        details = [event["detail"] for event in document["events"]]
        for robot_id in tipped:
            self.assertIn(f"robot {robot_id} tips over", details)
        self._check_gripper(robots, simulation.scenario)

    def _check_gripper(self, robots: Topic, scenario: Scenario) -> None:
        """Lift and drop a crate with a robot that stands at its start again, while its controller waits."""
        pause(robots)
        x, y, yaw = resolve(scenario).robots[0].start_pose
        self.assertTrue(call("/simulation/set_pose", SetPose, robot_id=0, pose=Pose2D(x, y, yaw)).success)
        ahead = Pose2D(x + 0.4 * math.cos(yaw), y + 0.4 * math.sin(yaw), yaw)
        self.assertTrue(
            call("/simulation/set_object", SetObject, name="crate", kind="barrel", radius_m=0.1, pose=ahead).success
        )
        answer = call("/simulation/lift_object", LiftObject, robot_id=0, name="crate")
        self.assertEqual((answer.success, answer.message), (True, ""))
        make_step(robots)
        self.assertEqual(list(robots.messages[-1].loads)[:1], ["crate"])
        again = call("/simulation/lift_object", LiftObject, robot_id=0, name="crate")
        self.assertEqual((again.success, again.message), (False, "robot_0 already holds 'crate'"))
        self.assertTrue(call("/simulation/drop_object", DropObject, robot_id=0).success)
        make_step(robots)
        self.assertEqual(list(robots.messages[-1].loads), [])
        nothing = call("/simulation/drop_object", DropObject, robot_id=0)
        self.assertEqual((nothing.success, nothing.message), (False, "robot_0 holds nothing"))


if __name__ == "__main__":
    rostest.rosrun("robotteamsim", "mujoco", MujocoTest)
