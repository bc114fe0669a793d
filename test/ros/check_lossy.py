#!/usr/bin/env python3
"""Compares a mission over a poor network in lockstep with the same mission run without ROS, message by message."""
# ruff: noqa: PT009 - rostest runs this by unittest, whose assertions tell the values

from __future__ import annotations

import rostest
from compared import ComparedMission, Log, by_stamp
from listening import Topic
from robotteamsim.msg import NetworkMessages, NetworkState

from robotteamsim.network.messages import Refusal, Traffic
from robotteamsim.simulation import StepRecord

ROBOTS = range(6)
Inbox = tuple[tuple[int, int, str], ...]


def inboxes_of(record: StepRecord) -> list[Inbox]:
    return [tuple((message.sender, message.receiver, message.payload) for message in inbox) for inbox in record.inboxes]


def traffic_of(message: NetworkState) -> Traffic:
    refused = zip(message.refused_senders, message.refused_bytes, strict=True)
    refusals = tuple(Refusal(sender, num_bytes, message.max_message_bytes) for sender, num_bytes in refused)
    return Traffic(message.delivered, message.lost, message.cut_off, message.mean_delay_s, refusals)


class LossyTest(ComparedMission):
    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        cls.network = Topic("/network/state", NetworkState)
        cls.received = [Topic(f"/robot_{i}/network/rx", NetworkMessages) for i in ROBOTS]
        cls.document = cls.document_at_end()
        cls.expected = Log(
            "garage_sar",
            [*cls.settings, f"robots.count={len(ROBOTS)}"],
            traffic=lambda record: record.network.traffic,
            hops=lambda record: int(record.network.hop_count.max()),
            inboxes=inboxes_of,
        )

    def test_mission_has_the_same_bits_and_events_as_without_ros(self) -> None:
        self.assert_as_expected(self.document, self.expected)
        self.assertEqual(self.document["result"]["end"], "time_limit")

    def test_the_network_is_as_poor_as_it_is_meant_to_be(self) -> None:
        traffic = self.expected.kept["traffic"].values()
        self.assertGreater(max(self.expected.kept["hops"].values()), 2)
        self.assertTrue(all(sum(getattr(t, name) for t in traffic) > 20 for name in ("delivered", "lost", "cut_off")))
        self.assertGreater(max(t.mean_delay_s for t in traffic), 0.1)
        kinds = {kind for _, kind, *_ in self.expected.events}
        self.assertLessEqual({"discovery_delivered", "message_too_large"}, kinds)

    def test_every_step_delivers_loses_and_rejects_the_same(self) -> None:
        found = {stamp_ns: traffic_of(message) for stamp_ns, message in by_stamp(self.network.messages).items()}
        self.assert_values(found, self.expected.kept["traffic"], 100)

    def test_every_robot_receives_the_same(self) -> None:
        for robot_id, topic in zip(ROBOTS, self.received, strict=True):
            found = {
                stamp_ns: tuple((m.sender, m.receiver, m.payload) for m in message.messages)
                for stamp_ns, message in by_stamp(topic.messages).items()
            }
            inboxes = {stamp_ns: of_all[robot_id] for stamp_ns, of_all in self.expected.kept["inboxes"].items()}
            self.assert_values(found, inboxes, 100)

    def test_result_has_the_discoveries_delivered_to_the_base(self) -> None:
        names = ("discoveries_delivered", "mean_delivery_delay_s", "max_delivery_delay_s")
        found = [self.document["result"][name] for name in names]
        self.assertEqual(found, [getattr(self.expected.result, name) for name in names])
        last = next(message for message in self.status.messages if message.state == "ended")
        self.assertTrue(last.has_base)
        self.assertEqual(last.discoveries_delivered, self.expected.result.discoveries_delivered)
        self.assertGreater(last.discoveries_delivered, 0)


if __name__ == "__main__":
    rostest.rosrun("robotteamsim", "lossy", LossyTest)
