#!/usr/bin/env python3
"""Compares a lockstep mission with a fire with the same mission without ROS."""
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
from geometry_msgs.msg import Point
from listening import Topic, call
from nav_msgs.msg import OccupancyGrid
from robotteamsim.msg import FloatMap, Heat, MissionStatus
from robotteamsim.srv import Ignite
from std_srvs.srv import Trigger

from robotteamsim.recording.hazard_messages import fire_cells
from robotteamsim.scenario import load
from robotteamsim.simulation import Result, Simulation, StepRecord

FILE = Path(os.environ["ROSTEST_OUT"]) / "mission.json"
SET = [
    "run.seed=7",
    "mission.time_limit_s=60",
    "control.exclusion.enabled=false",
    "fire.fuel=[{name: boxes, center: [8, 5], radius_m: 3, growth: ultra_fast, load_mj_m2: 600}]",
    "fire.ignitions=[{position: [7.2, 5.2]}]",
    "fire.heat.robot_limit_c=21",
    "fire.heat.robot_endures_s=3",
    "fire.casualties.collapse_dose=1e-8",
    "fire.casualties.lethal_dose=1e-6",
    "mission.victims.0.position=[9, 4]",
    "schedule=[{at_s: 20, ignite: [9.2, 6.2]}]",
]


class Expected:
    """Keeps what a simulation reports."""

    def __init__(self) -> None:
        self.events: list[tuple[float, str, str]] = []
        self.maps: dict[int, tuple[bytes, bytes, bytes]] = {}
        self.heat: dict[int, tuple[float, list[tuple[float, float]]]] = {}

    def begin(self, _: object) -> None:
        pass

    def step(self, record: StepRecord) -> None:
        self.events += [(event.time_s, event.kind, event.detail) for event in record.events]
        field = record.hazards
        if field is not None:
            maps = (fire_cells(field).tobytes(), field.temperatures_c.tobytes(), field.soot_g_m3.tobytes())
            self.maps[record.sim_time_ns] = maps
        heat = record.readings[2].further.heat if record.is_there(2) else None
        if heat is not None:
            self.heat[record.sim_time_ns] = heat.temperature_c, list(heat.hot_m)

    def end(self, _: Result) -> None:
        pass

    def abandon(self) -> None:
        pass


def by_stamp(topic: Topic) -> dict[int, Any]:
    return {message.header.stamp.to_nsec(): message for message in topic.messages}


class FireTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        rospy.init_node("fire_test", disable_rostime=True)
        cls.status = Topic("/mission/status", MissionStatus)
        cls.topics = [
            Topic("/fire/grid", OccupancyGrid),
            Topic("/fire/temperature", FloatMap),
            Topic("/smoke/soot", FloatMap),
        ]
        cls.heat = Topic("/robot_2/heat", Heat)
        cls.expected = Expected()
        cls.expected_result = Simulation(load("garage_fire", SET)).run([cls.expected])
        cls.first = cls.document_at_end(0)

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
        kinds = {event["kind"] for event in self.first["events"]}
        self.assertLessEqual({"robot_failed_by_heat", "victim_collapsed", "victim_dead"}, kinds)

    def test_maps_of_fire_and_smoke_have_the_bits_of_the_run_without_ros(self) -> None:
        seen = [by_stamp(topic) for topic in self.topics]
        stamps = [ns for ns in self.expected.maps if all(ns in messages for messages in seen)]
        self.assertGreater(len(stamps), 30)
        for stamp_ns in stamps:
            grid, temperature, soot = (messages[stamp_ns] for messages in seen)
            found = (
                np.array(grid.data, dtype=np.int8).tobytes(),
                np.array(temperature.data, dtype=np.float32).tobytes(),
                np.array(soot.data, dtype=np.float32).tobytes(),
            )
            self.assertEqual(found, self.expected.maps[stamp_ns], f"{stamp_ns} ns")
        self.assertEqual((temperature.unit, soot.unit), ("degC", "g/m^3"))
        self.assertIn(100, grid.data)

    def test_thermal_camera_measures_the_same_as_without_ros(self) -> None:
        seen = by_stamp(self.heat)
        stamps = [ns for ns in self.expected.heat if ns in seen]
        self.assertGreater(len(stamps), 5)
        for stamp_ns in stamps:
            message = seen[stamp_ns]
            found = message.temperature_c, [(place.x, place.y) for place in message.hot]
            self.assertEqual(found, self.expected.heat[stamp_ns], f"{stamp_ns} ns")

    def test_y_service_ignites_only_where_there_is_fuel(self) -> None:
        answer = call("/ignite", Ignite, position=Point(50.0, 20.0, 0.0))
        self.assertFalse(answer.success)
        self.assertIn("there is no fuel", answer.message)

    def test_z_reset_repeats_the_fire(self) -> None:
        begin = len(self.status.messages)
        self.assertTrue(call("/reset", Trigger).success)
        self.status.wait_for_after(begin, lambda message: message.state == "running", "state running")
        running = next(i for i, m in enumerate(self.status.messages) if i >= begin and m.state == "running")
        self.assert_as_expected(self.document_at_end(running))


if __name__ == "__main__":
    rostest.rosrun("robotteamsim", "fire", FireTest)
