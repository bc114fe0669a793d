"""Robots that another world moves."""

from __future__ import annotations

import math

import rospy

from robotteamsim.geometry import PoseReading
from robotteamsim.ros.elsewhere import RobotsElsewhere, SensorsElsewhere
from robotteamsim.ros.settings import Settings
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
    robots = RobotsElsewhere(Settings(load("garage_sar", ["robots.count=2"]), elsewhere=(0, 1)))
    stamps_ns = [robots.wait(lambda _: False) for _ in range(3)]
    assert stamps_ns == [0, 100_000_000, 200_000_000]
