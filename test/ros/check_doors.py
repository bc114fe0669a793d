#!/usr/bin/env python3
"""Closes a door that swings in a mission in lockstep, and compares all nodes with the same mission run without ROS."""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions tell the values

from __future__ import annotations

import json
import os
import unittest
from pathlib import Path
from typing import Any

import rospy
import rostest
from listening import Topic, call, catch_up, pause
from robotteamsim.msg import Doors, MissionStatus
from robotteamsim.srv import SetDoor
from std_srvs.srv import Trigger

from robotteamsim.scenario import load
from robotteamsim.simulation import Result, Simulation, StepRecord

FILE = Path(os.environ["ROSTEST_OUT"]) / "mission.json"
STEP_NS = 100_000_000
SET = ["run.seed=7", "mission.time_limit_s=15", "plan.doors.0.motion=swing", "plan.doors.0.time_s=3"]
DOOR = "plant_door"
OTHER_DOOR = "stair_door"


class Closing:
    """Sets both doors after a step of a simulation, and keeps what it tells of them."""

    def __init__(self, simulation: Simulation, step_index: int) -> None:
        self._simulation = simulation
        self._step_index = step_index
        self.events: list[tuple[float, str, str]] = []
        self.openings: dict[int, list[tuple[str, bool, float, str]]] = {}

    def begin(self, _: object) -> None:
        pass

    def step(self, record: StepRecord) -> None:
        self.events += [(event.time_s, event.kind, event.detail) for event in record.events]
        self.openings[record.sim_time_ns] = [
            (name, door.closed, door.opening, door.motion) for name, door in record.doors.items()
        ]
        if record.step_index == self._step_index:
            self._simulation.set_door(DOOR, True)
            self._simulation.set_door(OTHER_DOOR, False)

    def end(self, _: Result) -> None:
        pass

    def abandon(self) -> None:
        pass


class DoorsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        rospy.init_node("doors_test", disable_rostime=True)
        cls.doors = Topic("/world/doors", Doors)
        cls.status = Topic("/mission/status", MissionStatus)
        cls.status.wait_for_count(5)
        cls.step_index = pause().to_nsec() // STEP_NS
        cls.refused = call("/set_door", SetDoor, name="no_such_door", closed=True)
        assert call("/set_door", SetDoor, name=DOOR, closed=True).success
        assert call("/set_door", SetDoor, name=OTHER_DOOR, closed=False).success
        call("/resume", Trigger)
        cls.result = cls.document_at_end()
        catch_up(cls.doors)
        simulation = Simulation(load("garage_sar", SET))
        cls.expected = Closing(simulation, cls.step_index)
        cls.expected_result = simulation.run([cls.expected])

    @classmethod
    def document_at_end(cls) -> dict[str, Any]:
        cls.status.wait_for_after(len(cls.status.messages), lambda message: message.state == "ended", "state ended")
        return json.loads(FILE.read_text())

    def test_mission_with_a_door_that_swings_has_the_same_bits_and_events_as_without_ros(self) -> None:
        self.assertEqual(self.result["result"]["trajectory_hash"], self.expected_result.trajectory_hash)
        events = [(event["time_s"], event["kind"], event["detail"]) for event in self.result["events"]]
        self.assertEqual(events, self.expected.events)
        told = {detail for _, kind, detail in events if kind.startswith("door")}
        self.assertIn("door plant_door is closed", told)
        self.assertIn("door stair_door is opened", told)

    def test_world_tells_how_far_each_door_is_open_at_every_step_as_without_ros(self) -> None:
        last_run: dict[int, list[tuple[str, bool, float, str]]] = {}
        for message in self.doors.messages:
            stamp_ns = message.header.stamp.to_nsec()
            if stamp_ns > self.step_index * STEP_NS:
                last_run[stamp_ns] = [(door.name, door.closed, door.opening, door.motion) for door in message.doors]
        steps = [stamp_ns for stamp_ns in self.expected.openings if stamp_ns > self.step_index * STEP_NS]
        self.assertGreater(len(steps), 50)
        self.assertEqual([last_run[stamp_ns] for stamp_ns in steps], [self.expected.openings[ns] for ns in steps])
        self.assertTrue(any(0.0 < doors[0][2] < 1.0 for doors in last_run.values()))

    def test_unknown_door_is_refused_with_the_names_of_those_there_are(self) -> None:
        self.assertFalse(self.refused.success)
        self.assertEqual(self.refused.message, "unknown door 'no_such_door'; known: plant_door, stair_door")

    def test_z_reset_puts_the_doors_back_in_every_node(self) -> None:
        begin = len(self.doors.messages)
        self.assertTrue(call("/reset", Trigger).success)
        fresh = self.doors.wait_for_after(begin, lambda message: message.header.stamp.to_nsec() == STEP_NS, "step 1")
        self.assertEqual([(door.closed, door.opening) for door in fresh.doors], [(False, 1.0), (True, 0.0)])


if __name__ == "__main__":
    rostest.rosrun("robotteamsim", "doors", DoorsTest)
