#!/usr/bin/env python3
"""Compares a lockstep mission with a schedule and victims who walk with the same mission without ROS."""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions report the values

from __future__ import annotations

import json
import os
import unittest
from pathlib import Path
from typing import Any

import numpy as np
import rospy
import rostest
from listening import Topic, call
from robotteamsim.msg import FloatMap, MissionStatus, Victims
from std_srvs.srv import Trigger

from robotteamsim.scenario import load
from robotteamsim.simulation import Result, Simulation, StepRecord

FILE = Path(os.environ["ROSTEST_OUT"]) / "mission.json"
SET = [
    "run.seed=7",
    "mission.time_limit_s=15",
    "mission.victims.1.path=[[56.5, 20], [54, 20]]",
    "mission.victims.1.speed_mps=1.3",
    "mission.victims.2.wander={center: [35, 22.7], radius_m: 1.5}",
    "mission.victims.3.calling=false",
    "schedule=[{at_s: 0, noise_db: 12}, {at_s: 2, door: plant_door, closed: true}, {at_s: 3, noise_db: 20}, "
    "{at_s: 4, victim: victim_1, position: [6, 5]}, {at_s: 4, victim: eve, position: [10, 3]}]",
]
Places = list[tuple[str, float, float, str]]


class Expected:
    """Keeps what a simulation reports."""

    def __init__(self) -> None:
        self.events: list[tuple[float, str, str]] = []
        self.map_changes: dict[int, bytes] = {}
        self.places: dict[int, Places] = {}

    def begin(self, _: object) -> None:
        pass

    def step(self, record: StepRecord) -> None:
        self.events += [(event.time_s, event.kind, event.detail) for event in record.events]
        if record.voice_map is not None:
            self.map_changes[record.sim_time_ns] = record.voice_map.values.tobytes()
        states = zip(record.victims, record.mission.victims, strict=True)
        self.places[record.sim_time_ns] = [(victim.name, *victim.position, state) for victim, state in states]

    def end(self, _: Result) -> None:
        pass

    def abandon(self) -> None:
        pass


class ScheduleTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        rospy.init_node("schedule_test", disable_rostime=True)
        cls.status = Topic("/mission/status", MissionStatus)
        cls.victims = Topic("/mission/victims", Victims)
        cls.maps = Topic("/voice_map/values", FloatMap)
        cls.expected = Expected()
        cls.expected_result = Simulation(load("garage_sar", SET)).run([cls.expected])
        cls.first = cls.document_at_end(0)
        # On a busy machine this node may have subscribed late in the first mission, but it hears all of the second one.
        begin = len(cls.status.messages)
        assert call("/reset", Trigger).success
        cls.status.wait_for_after(begin, lambda message: message.state == "running", "state running")
        running = next(i for i, m in enumerate(cls.status.messages) if i >= begin and m.state == "running")
        cls.second = cls.document_at_end(running)

    @classmethod
    def document_at_end(cls, begin: int) -> dict[str, Any]:
        cls.status.wait_for_after(begin, lambda message: message.state == "ended", "state ended")
        return json.loads(FILE.read_text())

    def assert_as_expected(self, document: dict[str, Any]) -> None:
        events = [(event["time_s"], event["kind"], event["detail"]) for event in document["events"]]
        self.assertEqual(events, self.expected.events)
        self.assertEqual(document["result"]["trajectory_hash"], self.expected_result.trajectory_hash)

    def test_mission_has_the_same_bits_and_events_as_without_ros(self) -> None:
        self.assert_as_expected(self.first)
        told = [event["detail"] for event in self.first["events"]]
        for detail in (
            "background noise is 12 dB",
            "door plant_door is closed",
            "background noise is 20 dB",
            "victim victim_1 calls at (6.0, 5.0)",
            "victim eve calls at (10.0, 3.0)",
        ):
            self.assertIn(detail, told)

    def test_victims_on_the_topic_are_where_they_are_without_ros(self) -> None:
        seen = {
            message.header.stamp.to_nsec(): [(v.name, v.position.x, v.position.y, v.state) for v in message.victims]
            for message in self.victims.messages
        }
        steps = [stamp_ns for stamp_ns in self.expected.places if stamp_ns in seen]
        self.assertGreaterEqual(len(steps), 10)
        for stamp_ns in steps:
            self.assertEqual(seen[stamp_ns], self.expected.places[stamp_ns], f"{stamp_ns} ns")

    def test_voice_maps_change_in_the_same_steps_to_the_same_values(self) -> None:
        seen = {m.header.stamp.to_nsec(): np.array(m.data, dtype=np.float32).tobytes() for m in self.maps.messages}
        steps = [stamp_ns for stamp_ns in self.expected.map_changes if stamp_ns in seen]
        self.assertGreaterEqual(len(steps), 10)
        self.assertLessEqual({ns for ns in seen if 0 < ns <= steps[-1]}, set(self.expected.map_changes))
        for stamp_ns in steps:
            self.assertEqual(seen[stamp_ns], self.expected.map_changes[stamp_ns], f"{stamp_ns} ns")

    def test_reset_repeats_the_schedule(self) -> None:
        self.assert_as_expected(self.second)


if __name__ == "__main__":
    rostest.rosrun("robotteamsim", "schedule", ScheduleTest)
