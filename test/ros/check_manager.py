#!/usr/bin/env python3
"""Compares the mission that the mission manager judges from topics with that of the simulation beside it."""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions tell the values

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import rostest
from compared import EVENT_KEYS, FILE, ComparedMission, by_stamp
from listening import Topic
from robotteamsim.msg import Areas, MissionEvent, MissionStatus, Victims

JUDGED = Path(os.environ["ROSTEST_OUT"]) / "judged" / "mission.json"
TYPES = {"status": MissionStatus, "events": MissionEvent, "victims": Victims, "areas": Areas}
MANAGER = "/mission_manager"
STEPS = 600


def values(message: Any) -> str:
    """Return all that a message says, apart from its number and stamp."""
    return str(message).partition("frame_id")[2]


class ManagerTest(ComparedMission):
    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        cls.own = {name: Topic(f"/mission/{name}", kind) for name, kind in TYPES.items()}
        cls.judged = {name: Topic(f"{MANAGER}/mission/{name}", kind) for name, kind in TYPES.items()}
        for topic in (*cls.own.values(), *cls.judged.values()):
            assert topic.is_connected(60.0), topic.name
        cls.document_at_end()
        cls.judged["status"].wait_for_after(0, lambda message: message.state == "ended", "state ended")
        # Again from the first step, now that all have subscribed.
        begin = {name: (len(cls.own[name].messages), len(cls.judged[name].messages)) for name in TYPES}
        cls.result = cls.document_after("/simulation/reset")["result"]
        cls.judged["status"].wait_for_after(begin["status"][1], lambda message: message.state == "ended", "state ended")
        cls.begin = begin

    def messages(self, name: str) -> tuple[list[Any], list[Any]]:
        """Return the messages of the second run, of the simulation and of the manager."""
        own, judged = self.begin[name]
        return self.own[name].messages[own:], self.judged[name].messages[judged:]

    def test_status_of_every_step_is_that_of_the_simulation(self) -> None:
        own, judged = self.messages("status")
        # The simulation goes on after the first mission, until the reset, whose status has the stamp 0.
        begin = max(index for index, message in enumerate(own) if not message.header.stamp)
        steps, found = by_stamp(own[begin + 1 :]), by_stamp(judged)
        ended_ns = next(stamp for stamp, message in steps.items() if message.state == "ended")
        expected = {stamp: values(message) for stamp, message in steps.items() if stamp <= ended_ns}
        self.assertGreaterEqual(len(expected), STEPS)
        self.assertEqual({stamp: values(message) for stamp, message in found.items()}, expected)

    def test_events_victims_and_areas_are_those_of_the_simulation(self) -> None:
        events = []
        for topic in (self.own["events"], self.judged["events"]):
            starts = [index for index, event in enumerate(topic.messages) if event.kind == "start"]
            topic.wait_for_after(starts[-1], lambda event: event.kind == "end", "the end")  # it follows the status
            events.append([tuple(getattr(event, key) for key in EVENT_KEYS) for event in topic.messages[starts[-1] :]])
        self.assertGreater(len(events[0]), 2)
        self.assertEqual(events[1], events[0])
        for name in ("victims", "areas"):
            last = values(self.own[name].messages[-1])
            self.judged[name].wait_for_after(self.begin[name][1], lambda message: values(message) == last, last)  # noqa: B023

    def test_totals_and_the_hash_are_those_of_the_simulation(self) -> None:
        results = [json.loads(path.read_text())["result"] for path in (FILE, JUDGED)]
        for result in results:
            del result["wall_s"]
        self.assertEqual(results[1], results[0])


if __name__ == "__main__":
    rostest.rosrun("robotteamsim", "manager", ManagerTest)
