#!/usr/bin/env python3
"""Compares a mission in lockstep with the same mission run without ROS."""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions tell the values

from __future__ import annotations

import json
import os
import unittest
from pathlib import Path
from typing import Any

import rospy
import rostest
from listening import Topic, call
from robotteamsim.msg import MissionStatus
from std_srvs.srv import Trigger

from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation

FILE = Path(os.environ["ROSTEST_OUT"]) / "mission.json"


class LockstepTest(unittest.TestCase):
    def test_mission_has_the_same_bits_as_without_ros_and_again_after_a_reset(self) -> None:
        rospy.init_node("lockstep_test", disable_rostime=True)
        status = Topic("/mission/status", MissionStatus)
        headless = Simulation(load("garage_sar", ["mission.time_limit_s=30", "run.seed=7"])).run()
        first = self._result(status, 0)
        self.assertEqual(first["trajectory_hash"], headless.trajectory_hash)
        self.assertEqual((first["steps"], first["end"], first["seed"]), (headless.steps, "time_limit", 7))
        self.assertEqual([robot["distance_m"] for robot in first["robots"]], [r.distance_m for r in headless.robots])
        FILE.unlink()
        begin = len(status.messages)
        self.assertTrue(call("/reset", Trigger).success)
        self.assertEqual(self._result(status, begin)["trajectory_hash"], headless.trajectory_hash)

    def _result(self, status: Topic, begin: int) -> dict[str, Any]:
        status.wait_for_after(begin, lambda message: message.state == "running", "state running")
        running = next(i for i, message in enumerate(status.messages) if i >= begin and message.state == "running")
        status.wait_for_after(running, lambda message: message.state == "ended", "state ended")
        # The file is complete before the mission's end is told.
        return json.loads(FILE.read_text())["result"]


if __name__ == "__main__":
    rostest.rosrun("robotteamsim", "lockstep", LockstepTest)
