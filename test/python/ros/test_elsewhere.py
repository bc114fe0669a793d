"""Robots that another world moves."""

from __future__ import annotations

import io
import itertools
import math
from types import SimpleNamespace

import pytest
import rospy
from nav_msgs.msg import Odometry

from robotteamsim.geometry import PoseReading
from robotteamsim.nodes import elsewhere
from robotteamsim.nodes.elsewhere import RobotsElsewhere, SensorsElsewhere
from robotteamsim.nodes.settings import Settings
from robotteamsim.ros.ros1 import Ros1Node
from robotteamsim.scenario import load
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.setup import resolve
from robotteamsim.world import World


class Elsewhere:
    """Robots 0 and 1, which still report where they are."""

    def __init__(self, readings):
        self._readings = readings

    def readings(self):
        return dict(enumerate(self._readings))


def test_removed_robot_is_absent_wherever_it_lies():
    scenario = load("garage_sar", ["robots.count=2"])
    robots = resolve(scenario).robots
    world = World(scenario.plan, robots, scenario.run)
    inside = RobotSensors(world, robots, scenario.run.seed)
    sensors = SensorsElsewhere(inside, Elsewhere(list(inside.read())), world)
    there = sensors.read()[1].ground_truth
    assert isinstance(there, PoseReading)
    assert not math.isnan(there.x_m)
    world.remove_robot(1)
    readings = sensors.read()
    assert math.isnan(readings[1].ground_truth.x_m)
    assert not math.isnan(readings[0].ground_truth.x_m)


def test_steps_go_on_when_no_robot_is_left_so_that_the_mission_ends(monkeypatch):
    monkeypatch.setattr(rospy, "Subscriber", lambda *_, **__: None)
    robots = RobotsElsewhere(Ros1Node(), Settings(load("garage_sar", ["robots.count=2"]), elsewhere=(0, 1)))
    stamps_ns = [robots.wait(lambda _: False) for _ in range(3)]
    assert stamps_ns == [0, 100_000_000, 200_000_000]


@pytest.fixture
def send(monkeypatch):
    """Return a function that publishes the true pose of robot 0 at a time [ms]."""
    subscribers = {}
    monkeypatch.setattr(rospy, "Subscriber", lambda topic, _, receive, **__: subscribers.update({topic: receive}))

    def publish(time_ms):
        message, raw = Odometry(), io.BytesIO()
        message.header.stamp, message.pose.pose.orientation.w = rospy.Time(0, time_ms * 10**6), 1.0
        message.serialize(raw)
        subscribers["/robot_0/base_pose_ground_truth"](SimpleNamespace(data=raw.getvalue()))

    return publish


@pytest.mark.parametrize(
    ("sent_ms", "skipped"),
    [
        ((100, 200, 300), 0),
        ((5000, 5100, 5200), 0),
        ((5000, 5140, 5190, 5310), 0),
        ((5000, 5100, 5600, 5700, 5900), 5),
    ],
    ids=["from the first step on", "later", "with jitter", "with gaps"],
)
def test_each_step_of_the_other_world_is_taken_once_and_those_left_out_are_counted(send, monkeypatch, sent_ms, skipped):
    monkeypatch.setattr(elsewhere, "CHECK_PERIOD_S", 0.01)
    robots = RobotsElsewhere(Ros1Node(), Settings(load("garage_sar", ["robots.count=1"]), elsewhere=(0,)))

    def take(time_ms):
        """Wait for a step whose message comes during the wait."""
        looks = itertools.count()

        def is_present(_):
            if next(looks) == 1:
                send(time_ms)
            return True

        return robots.wait(is_present)

    taken_ns = [take(time_ms) for time_ms in sent_ms]
    assert taken_ns == [time_ms * 10**6 for time_ms in sent_ms]
    assert robots.skipped_steps == skipped
    robots.restart()
    assert robots.skipped_steps == 0


def test_wait_ends_when_the_time_of_the_other_world_jumps_back(send, monkeypatch):
    monkeypatch.setattr(elsewhere, "CHECK_PERIOD_S", 0.01)
    robots = RobotsElsewhere(Ros1Node(), Settings(load("garage_sar", ["robots.count=1"]), elsewhere=(0,)))
    send(100_000)
    assert robots.wait(lambda _: True) == 100 * 10**9
    send(100)
    assert robots.wait(lambda _: True) is None
    assert robots.has_jumped_back
    robots.restart()
    send(200)
    assert robots.wait(lambda _: True) == 200 * 10**6
