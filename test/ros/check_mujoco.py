#!/usr/bin/env python3
"""Compares a mission in the world of MuJoCo, in lockstep, with the same mission run without ROS."""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions tell the values

from __future__ import annotations

import json
import os
import unittest
from pathlib import Path

import rospy
import rostest
from listening import Topic
from robotteamsim.msg import MissionStatus, Robots

from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation

FOLDER = Path(os.environ["ROSTEST_OUT"])
KEYS = [
    "run.world=mujoco",
    "run.seed=7",
    "mission.time_limit_s=6",
    "robots.height_m=2",
    "robots.radius_m=0.1",
    "control.max_step_speed_mps=3",
    "robots.drive={max_speed_mps: 3, max_acceleration_mps2: 50, max_turn_radps: 6}",
]


class MujocoTest(unittest.TestCase):
    def test_mission_and_mishaps_are_those_without_ros(self) -> None:
        rospy.init_node("mujoco_test", disable_rostime=True)
        robots, status = Topic("/world/robots", Robots), Topic("/mission/status", MissionStatus)
        status.wait_for_after(0, lambda message: message.state == "ended", "state ended")
        document = json.loads((FOLDER / "mission.json").read_text(encoding="utf-8"))
        found = document["result"]
        simulation = Simulation(load("garage_sar", KEYS))
        expected = simulation.run()
        self.assertEqual((found["trajectory_hash"], found["steps"]), (expected.trajectory_hash, expected.steps))
        tipped = [robot_id for robot_id, mishap in simulation.world.mishaps.items() if mishap == "tipped_over"]
        self.assertNotEqual(tipped, [])
        last = robots.wait_for_after(0, lambda message: sum(message.mishaps) == len(tipped), "all mishaps")
        self.assertEqual([i for i, mishap in enumerate(last.mishaps) if mishap == Robots.TIPPED_OVER], tipped)
        details = [event["detail"] for event in document["events"]]
        for robot_id in tipped:
            self.assertIn(f"robot {robot_id} tips over", details)


if __name__ == "__main__":
    rostest.rosrun("robotteamsim", "mujoco", MujocoTest)
