from __future__ import annotations

import pytest

from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.recording import ros_messages
from robotteamsim.ros.nodes import stage
from robotteamsim.ros.nodes.gate import Pacer
from robotteamsim.ros.nodes.stage import StageRequests, UnprefixedTypes, robot_topic
from robotteamsim.ros.transport.serialization import serialized
from robotteamsim.sensing.readings import OdometryReading


class Queue:
    """Has these requests, then is closed."""

    def __init__(self, requests: list[str | bytes]) -> None:
        self._requests = requests
        self.topics: list[str] = []
        self.is_closed = False

    def subscribe(self, topic: str, *_: object) -> None:
        self.topics.append(topic)

    def take(self, timeout_s: float) -> list[tuple[int, int, bytes]]:
        self.is_closed = True
        return [
            (0, 0, request if isinstance(request, bytes) else serialized(stage.String(data=request)))
            for request in self._requests
        ]


class Thread:
    """Runs at once."""

    def __init__(self, target, daemon: bool) -> None:
        self.start = target


@pytest.mark.parametrize(
    ("requests", "speeds"),
    [
        (["speedup_4.0"], [4.0]),
        (["speedup", "speedup_0.5"], [2.0, 0.5]),
        (["footprints", "screenshot", "", "speed"], []),
        ([b"\x01", "speedup_4.0"], [4.0]),  # the first one cannot be read
    ],
)
def test_speedup_of_stage_sets_the_speed_and_other_requests_do_nothing(monkeypatch, requests, speeds):
    queue, given = Queue(requests), []
    monkeypatch.setattr(stage, "message_queue", lambda: queue)
    monkeypatch.setattr(stage.threading, "Thread", Thread)
    StageRequests(given.append)
    assert queue.topics == ["/stageGUIRequest"]
    assert given == speeds


@pytest.mark.parametrize(
    ("request_", "reason"),
    [
        ("speedup_fast", "'fast' is not a number"),
        ("speedup_-1", "speed must be finite and >= 0, got -1"),
        ("speedup_nan", "speed must be finite and >= 0, got nan"),
    ],
)
def test_wrong_speedup_is_ignored_with_one_line(monkeypatch, caplog, request_, reason):
    monkeypatch.setattr(stage, "message_queue", lambda: Queue([request_]))
    monkeypatch.setattr(stage.threading, "Thread", Thread)
    StageRequests(Pacer(1.0).set_speed)
    assert [record.getMessage() for record in caplog.records] == [f"/stageGUIRequest: ignoring {request_!r}: {reason}"]


def test_single_robot_of_stage_has_topics_and_frames_without_a_prefix(hall_scenario):
    make, robot = UnprefixedTypes(), hall_scenario().robots[0]
    links = ros_messages.transforms(
        make, 0, [robot], [OdometryReading(PoseReading(0.0, 0.0, 0.0, 1.0), Twist())]
    ).transforms
    frames = [(link.header.frame_id, link.child_frame_id) for link in links]
    assert frames == [("odom", "base_footprint"), ("base_footprint", "base_link"), ("base_link", "base_laser_link")]
    assert ros_messages.contact(make, 0, 0, in_contact=False).header.frame_id == "base_link"
    assert robot_topic(0, "odom", prefix=False) == "/odom"
    assert robot_topic(0, "odom", prefix=True) == "/robot_0/odom"
