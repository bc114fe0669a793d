#!/usr/bin/env python3
"""Compares a mission over a poor network in lockstep with the same mission run without ROS, message by message."""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions tell the values

from __future__ import annotations

import json
import os
import unittest
from pathlib import Path
from typing import Any

import rospy
import rostest
from listening import Topic
from robotteamsim.msg import MissionStatus, NetworkMessages, NetworkState

from robotteamsim.network.messages import Refusal, Traffic
from robotteamsim.scenario import load
from robotteamsim.simulation import Result, Simulation, StepRecord

FILE = Path(os.environ["ROSTEST_OUT"]) / "mission.json"
ROBOTS = range(6)
SEED, MAX_BYTES = 7, 297
Inbox = tuple[tuple[int, int, str], ...]


class Log:
    """Keeps what a simulation tells of its messages and events, by stamp [ns]."""

    def __init__(self) -> None:
        self.traffic: dict[int, Traffic] = {}
        self.inboxes: dict[int, list[Inbox]] = {}
        self.events: list[tuple[float, str, str, int, str]] = []
        self.max_hops = 0

    def begin(self, _: object) -> None:
        pass

    def step(self, record: StepRecord) -> None:
        self.traffic[record.sim_time_ns] = record.network.traffic
        self.inboxes[record.sim_time_ns] = [
            tuple((message.sender, message.receiver, message.payload) for message in inbox) for inbox in record.inboxes
        ]
        self.events += [(e.time_s, e.kind, e.subject, e.robot_id, e.detail) for e in record.events]
        self.max_hops = max(self.max_hops, int(record.network.hop_count.max()))

    def end(self, _: Result) -> None:
        pass

    def abandon(self) -> None:
        pass


def stamp_ns(message: Any) -> int:
    return message.header.stamp.to_nsec()


def traffic_of(message: NetworkState) -> Traffic:
    refused = zip(message.refused_senders, message.refused_bytes, strict=True)
    refusals = tuple(Refusal(sender, num_bytes, message.max_message_bytes) for sender, num_bytes in refused)
    return Traffic(message.delivered, message.lost, message.cut_off, message.mean_delay_s, refusals)


class LossyTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        rospy.init_node("lossy_test", disable_rostime=True)
        cls.network = Topic("/network/state", NetworkState)
        cls.received = [Topic(f"/robot_{i}/network/rx", NetworkMessages) for i in ROBOTS]
        cls.status = Topic("/mission/status", MissionStatus)
        cls.status.wait_for_after(0, lambda message: message.state == "ended", "state ended")
        cls.document = json.loads(FILE.read_text())
        settings = rospy.get_param("/robotteamsim/set").split()
        cls.expected = Log()
        scenario = load("garage_sar", [*settings, f"run.seed={SEED}", f"robots.count={len(ROBOTS)}"])
        cls.result = Simulation(scenario).run([cls.expected])

    def test_mission_has_the_same_bits_and_events_as_without_ros(self) -> None:
        result = self.document["result"]
        self.assertEqual(result["trajectory_hash"], self.result.trajectory_hash)
        self.assertEqual((result["steps"], result["end"]), (self.result.steps, "time_limit"))
        events = [(e["time_s"], e["kind"], e["subject"], e["robot_id"], e["detail"]) for e in self.document["events"]]
        self.assertEqual(events, self.expected.events)

    def test_the_network_is_as_poor_as_it_is_meant_to_be(self) -> None:
        traffic = self.expected.traffic.values()
        self.assertGreater(self.expected.max_hops, 2)
        self.assertTrue(all(sum(getattr(t, name) for t in traffic) > 20 for name in ("delivered", "lost", "cut_off")))
        self.assertGreater(max(t.mean_delay_s for t in traffic), 0.1)
        kinds = {kind for _, kind, _, _, _ in self.expected.events}
        self.assertLessEqual({"discovery_delivered", "message_too_large"}, kinds)

    def test_every_step_delivers_loses_and_refuses_the_same(self) -> None:
        told = {stamp_ns(message): traffic_of(message) for message in self.network.messages}
        heard = {ns: traffic for ns, traffic in self.expected.traffic.items() if ns in told}
        self.assertGreater(len(heard), 100)
        self.assertEqual({ns: told[ns] for ns in heard}, heard)

    def test_every_robot_receives_the_same(self) -> None:
        for robot_id, topic in zip(ROBOTS, self.received, strict=True):
            told = {
                stamp_ns(message): tuple((m.sender, m.receiver, m.payload) for m in message.messages)
                for message in topic.messages
            }
            heard = {ns: inboxes[robot_id] for ns, inboxes in self.expected.inboxes.items() if ns in told}
            self.assertGreater(len(heard), 100)
            self.assertEqual({ns: told[ns] for ns in heard}, heard, topic.name)

    def test_result_has_what_was_delivered_to_the_base(self) -> None:
        result = self.document["result"]
        names = ("discoveries_delivered", "mean_delivery_delay_s", "max_delivery_delay_s")
        self.assertEqual([result[name] for name in names], [getattr(self.result, name) for name in names])
        last = next(message for message in self.status.messages if message.state == "ended")
        self.assertTrue(last.has_base)
        self.assertEqual(last.discoveries_delivered, self.result.discoveries_delivered)
        self.assertGreater(last.discoveries_delivered, 0)


if __name__ == "__main__":
    rostest.rosrun("robotteamsim", "lossy", LossyTest)
