#!/usr/bin/env python3
"""Takes robots off the floor and puts them back in a lockstep mission, and compares it with the same without ROS."""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions tell the values

from __future__ import annotations

import json
import os
import unittest
from pathlib import Path
from typing import Any

import rospy
import rostest
from geometry_msgs.msg import Pose2D
from listening import Topic, call, catch_up, pause, place_m
from nav_msgs.msg import Odometry
from robotteamsim.msg import MissionStatus, Robots
from robotteamsim.srv import GetRadioMap, RemoveRobot, SpawnRobot, Step
from std_srvs.srv import Trigger

from robotteamsim.geometry import Pose
from robotteamsim.scenario import load
from robotteamsim.simulation import Result, Simulation, StepRecord

FILE = Path(os.environ["ROSTEST_OUT"]) / "mission.json"
STEP_NS = 100_000_000
SET = [
    "run.seed=7",
    "mission.time_limit_s=20",
    "robots.count=4",
    "robots.reserve=1",
    "schedule=[{at_s: 4, remove: 0}, {at_s: 6, spawn: 0}]",
]
AWAY_STEPS = 10
"""Steps from the removal of robot 1 to its coming again."""
THERE = Pose2D(10.0, 3.0, 0.5)


class Course:
    """Does the same to a simulation as the test does to the world, and keeps what it tells."""

    def __init__(self, simulation: Simulation, step_index: int) -> None:
        self._simulation = simulation
        self._step_index = step_index
        self.events: list[tuple[float, str, str]] = []
        self.present: dict[int, list[int]] = {}

    def begin(self, _: object) -> None:
        pass

    def step(self, record: StepRecord) -> None:
        self.events += [(event.time_s, event.kind, event.detail) for event in record.events]
        self.present[record.sim_time_ns] = [int(record.is_there(i)) for i in range(4)]
        if record.step_index == self._step_index:
            self._simulation.remove_robot(1)
            self._simulation.spawn_robot(3)
        if record.step_index == self._step_index + AWAY_STEPS:
            self._simulation.spawn_robot(1, Pose(THERE.x, THERE.y, THERE.theta))
            self._simulation.remove_robot(2)
            self._simulation.spawn_robot(2)

    def end(self, _: Result) -> None:
        pass

    def abandon(self) -> None:
        pass


class LeavingTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        rospy.init_node("leaving_test", disable_rostime=True)
        cls.who = Topic("/world/robots", Robots)
        cls.status = Topic("/mission/status", MissionStatus)
        cls.odometry = [Topic(f"/robot_{i}/odom", Odometry) for i in range(4)]
        cls.status.wait_for_count(5)
        cls.step_index = pause().to_nsec() // STEP_NS
        cls.refused = [
            call("/remove_robot", RemoveRobot, robot_id=4),
            call("/remove_robot", RemoveRobot, robot_id=3),
            call("/spawn_robot", SpawnRobot, robot_id=1, at_start=True),
            call("/spawn_robot", SpawnRobot, robot_id=3, pose=Pose2D(10.0, 0.2, 0.0)),
            call("/spawn_robot", SpawnRobot, robot_id=3, pose=Pose2D(float("nan"), 3.0, 0.0)),
            call("/get_radio_map", GetRadioMap, robot_id=3),
        ]
        assert call("/remove_robot", RemoveRobot, robot_id=1).success
        assert call("/spawn_robot", SpawnRobot, robot_id=3, at_start=True).success
        assert call("/step", Step, steps=AWAY_STEPS).success
        assert call("/spawn_robot", SpawnRobot, robot_id=1, pose=THERE).success
        assert call("/remove_robot", RemoveRobot, robot_id=2).success
        assert call("/spawn_robot", SpawnRobot, robot_id=2, at_start=True).success
        call("/resume", Trigger)
        cls.result = cls.document_at_end(0)
        catch_up(cls.who, cls.odometry[1])
        cls.expected = Course(Simulation(load("garage_sar", SET)), cls.step_index)
        cls.expected_result = cls.expected._simulation.run([cls.expected])

    @classmethod
    def document_at_end(cls, begin: int) -> dict[str, Any]:
        cls.status.wait_for_after(begin, lambda message: message.state == "ended", "state ended")
        return json.loads(FILE.read_text())

    def test_mission_has_the_same_bits_and_events_as_without_ros(self) -> None:
        events = [(event["time_s"], event["kind"], event["detail"]) for event in self.result["events"]]
        self.assertEqual(events, self.expected.events)
        told = [detail for _, kind, detail in events if kind in ("robot_removed", "robot_spawned")]
        for line in (
            "robot 1 is removed",
            "robot 3 is spawned",
            "robot 1 is spawned",
            "robot 0 is removed",
            "robot 0 is spawned",
        ):
            self.assertIn(line, told)
        self.assertEqual(self.result["result"]["trajectory_hash"], self.expected_result.trajectory_hash)

    def test_world_tells_who_is_there_in_every_step(self) -> None:
        told = {m.header.stamp.to_nsec(): list(m.present) for m in self.who.messages}
        steps = [ns for ns in self.expected.present if ns in told]
        self.assertGreater(len(steps), 100)
        self.assertEqual([told[ns] for ns in steps], [self.expected.present[ns] for ns in steps])

    def test_topics_are_silent_while_the_robot_is_not_there_and_odometry_begins_anew(self) -> None:
        away = range(self.step_index + 1, self.step_index + AWAY_STEPS + 1)
        told = {m.header.stamp.to_nsec() // STEP_NS: m for m in self.odometry[1].messages}
        self.assertFalse(set(away) & set(told))
        self.assertEqual(place_m(told[away[-1] + 1]), (0.0, 0.0))
        self.assertNotEqual(place_m(told[away[0] - 1]), (0.0, 0.0))

    def test_what_cannot_be_is_refused_with_the_reason(self) -> None:
        reasons = [
            "robot_id must be in 0..3, got 4",
            "robot_3 is not present; it cannot be removed",
            "robot_1 is already present; it cannot be spawned",
            "robot_3: pose (10.00, 0.20) is inside wall 'south'; expected 0.2 m of clearance",
            "robot_3: pose must be finite",
            "robot_id: 3; the robot is not present",
        ]
        for refused, reason in zip(self.refused, reasons, strict=True):
            self.assertFalse(refused.success)
            self.assertIn(reason, refused.message)

    def test_z_reset_brings_back_who_was_there_at_the_start_and_the_run_without_services(self) -> None:
        begin, seen = len(self.status.messages), len(self.who.messages)
        self.assertTrue(call("/reset", Trigger).success)
        fresh = self.who.wait_for_after(seen, lambda message: message.header.stamp.to_nsec() == STEP_NS, "step 1")
        self.assertEqual((list(fresh.present), list(fresh.arrivals)), ([1, 1, 1, 0], [1, 1, 1, 0]))
        self.status.wait_for_after(begin, lambda message: message.state == "running", "state running")
        running = next(i for i, m in enumerate(self.status.messages) if i >= begin and m.state == "running")
        again = self.document_at_end(running)
        self.assertEqual(again["result"]["trajectory_hash"], Simulation(load("garage_sar", SET)).run().trajectory_hash)


if __name__ == "__main__":
    rostest.rosrun("robotteamsim", "leaving", LeavingTest)
