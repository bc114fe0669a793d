from __future__ import annotations

from dataclasses import replace

import pytest
import rospy

from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.nodes.gate import Pacer
from robotteamsim.nodes.settings import Settings
from robotteamsim.nodes.stage import StageRequests, unprefixed
from robotteamsim.recording.topics import robots
from robotteamsim.ros.ros1 import Ros1Node
from robotteamsim.scenario import load
from robotteamsim.sensing.readings import OdometryReading


@pytest.fixture
def follow(monkeypatch):
    """Return a function that follows a request, and sets the speed of a pacer or adds it to a list."""
    monkeypatch.setattr(rospy, "Subscriber", lambda *_, **__: None)

    def follow(request, set_speed):
        StageRequests(Ros1Node(), set_speed).follow(request)

    return follow


@pytest.mark.parametrize(
    ("request_", "speeds"),
    [("speedup_4.0", [4.0]), ("speedup", [2.0]), ("footprints", []), ("screenshot", []), ("", []), ("speed", [])],
)
def test_speedup_of_stage_sets_the_speed_and_other_requests_do_nothing(follow, request_, speeds):
    given: list[float] = []
    follow(request_, given.append)
    assert given == speeds


@pytest.mark.parametrize(
    ("request_", "reason"),
    [
        ("speedup_fast", "'fast' is not a number"),
        ("speedup_-1", "speed must be finite and >= 0, got -1"),
        ("speedup_nan", "speed must be finite and >= 0, got nan"),
    ],
)
def test_wrong_speedup_is_ignored_with_one_line(follow, caplog, request_, reason):
    follow(request_, Pacer(1.0).set_speed)
    assert [record.getMessage() for record in caplog.records] == [f"/stageGUIRequest: ignoring {request_!r}: {reason}"]


def test_single_robot_of_stage_has_topics_and_frames_without_a_prefix(hall_scenario):
    robot = hall_scenario().robots[0]
    links = robots.robot_transforms(0, 0, robot, OdometryReading(PoseReading(0.0, 0.0, 0.0, 1.0), Twist()))
    links = [unprefixed(link, 0) for link in links]
    frames = [(link["header"]["frame_id"], link["child_frame_id"]) for link in links]
    assert frames == [("odom", "base_footprint"), ("base_footprint", "base_link"), ("base_link", "base_laser_link")]
    assert unprefixed(robots.contact(0, 0, in_contact=False), 0)["header"]["frame_id"] == "base_link"
    settings = Settings(load("tutorial_arena"))
    assert replace(settings, prefix=False).robot_topic(0, "odom") == "/odom"
    assert settings.robot_topic(0, "odom") == "/robot_0/odom"
