"""What the tests share that compare a mission in ROS with the same mission without it."""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions report the values

from __future__ import annotations

import json
import os
import unittest
from collections.abc import Callable
from pathlib import Path
from typing import Any

import rospy
from listening import Topic, call
from robotteamsim.msg import MissionStatus
from std_srvs.srv import Trigger

from robotteamsim.scenario import load
from robotteamsim.simulation import Result, Simulation, StepRecord

FILE = Path(os.environ["ROSTEST_OUT"]) / "mission.json"
STEP_NS = 100_000_000
EVENT_KEYS = ("time_s", "kind", "subject", "robot_id", "detail")


class Log:
    """Runs a mission without ROS and keeps its events and, by stamp [ns], what functions of each record return.

    Args: after: does something to the simulation after a step.  kept: None is not kept.
    """

    def __init__(
        self,
        scenario: str,
        settings: list[str],
        after: Callable[[Simulation, int], None] = lambda simulation, step_index: None,
        **kept: Callable[[StepRecord], Any],
    ) -> None:
        self.events: list[tuple[object, ...]] = []
        self.kept: dict[str, dict[int, Any]] = {name: {} for name in kept}
        self._functions, self._after = kept, after
        self.simulation = Simulation(load(scenario, settings))
        self.result = self.simulation.run([self])

    def begin(self, _: object) -> None:
        pass

    def step(self, record: StepRecord) -> None:
        self.events += [tuple(getattr(event, key) for key in EVENT_KEYS) for event in record.events]
        for name, function in self._functions.items():
            value = function(record)
            if value is not None:
                self.kept[name][record.sim_time_ns] = value
        self._after(self.simulation, record.step_index)

    def end(self, _: Result) -> None:
        pass

    def abandon(self) -> None:
        pass


def by_stamp(messages: Any) -> dict[int, Any]:
    return {message.header.stamp.to_nsec(): message for message in messages}


class ComparedMission(unittest.TestCase):
    """A mission that writes its results into `FILE` at its end."""

    @classmethod
    def setUpClass(cls) -> None:
        rospy.init_node("compared", disable_rostime=True)
        cls.status = Topic("/mission/status", MissionStatus)
        seed, changed = (rospy.get_param(f"/robotteamsim/{name}") for name in ("seed", "set"))
        cls.settings = [f"run.seed={seed}", *changed.split()]

    @classmethod
    def document_at_end(cls, begin: int = 0) -> dict[str, Any]:
        """Return the results of the mission of the status message counted, or of a later one."""
        cls.status.wait_for_after(begin, lambda message: message.state == "ended", "state ended")
        # The file is complete before the end of the mission is published.
        return json.loads(FILE.read_text())

    @classmethod
    def document_after(cls, service: str, service_class: type = Trigger, **fields: object) -> dict[str, Any]:
        """Restart the mission by a service and return its results."""
        begin = len(cls.status.messages)
        assert call(service, service_class, **fields).success
        cls.status.wait_for_after(begin, lambda message: message.state == "running", "state running")
        running = next(i for i, m in enumerate(cls.status.messages) if i >= begin and m.state == "running")
        return cls.document_at_end(running)

    def assert_as_expected(self, document: dict[str, Any], expected: Log) -> None:
        events = [tuple(event[key] for key in EVENT_KEYS) for event in document["events"]]
        self.assertEqual(events, expected.events)
        self.assertEqual(document["result"]["trajectory_hash"], expected.result.trajectory_hash)
        self.assertEqual(document["result"]["steps"], expected.result.steps)

    def assert_values(self, found: dict[int, Any], expected: dict[int, Any], at_least: int) -> None:
        """Check that values are those of the same steps without ROS."""
        stamps = [stamp_ns for stamp_ns in expected if stamp_ns in found]
        self.assertGreaterEqual(len(stamps), at_least)
        for stamp_ns in stamps:
            self.assertEqual(found[stamp_ns], expected[stamp_ns], f"{stamp_ns} ns")
