"""The readings of a robot from its topics are those of a run without ROS."""

from __future__ import annotations

import numpy as np
import pytest

from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.nodes.inputs import RobotInputs
from robotteamsim.nodes.settings import Settings
from robotteamsim.recording.bag_types import message_type
from robotteamsim.recording.topics import robots
from robotteamsim.ros.ros1 import Ros1Node
from robotteamsim.scenario import load
from robotteamsim.sensing.readings import OdometryReading
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.setup import resolve
from robotteamsim.world import World

STILL = OdometryReading(PoseReading(0.0, 0.0, 0.0, 1.0), Twist())
EQUIPPED = (
    "robots.sensors=["
    "{kind: laser, name: rear, yaw_rad: 3.1416, beams: 31, noise_m: 0.01, every_steps: 3}, "
    "{kind: laser, name: left, beams: 7}, "
    "{kind: sonar, name: sonar_0, noise_m: 0.02}, {kind: sonar, name: sonar_1, yaw_rad: 1.5}, "
    "{kind: gps, datum_lat_deg: 40.186, datum_lon_deg: -8.416, rate_hz: 4}]",
)


@pytest.fixture
def course():
    """Return the inputs of a robot, and for each step its stamp, its readings without ROS, and the values of topics."""
    scenario = load("tutorial_arena", EQUIPPED)
    team = resolve(scenario).robots
    world = World(scenario.plan, team, scenario.run)
    sensors = RobotSensors(world, team, 3)
    inputs = RobotInputs(Ros1Node(), Settings(scenario), 0)
    steps = []
    for _ in range(24):
        world.step([Twist(0.3, 0.0, 0.2)])
        reading = sensors.read()[0]
        steps.append((world.sim_time_ns, reading, values_of(inputs, team[0], world.sim_time_ns, reading)))
    return inputs, steps


def values_of(inputs, robot, time_ns, reading):
    sent = {
        inputs.odometry.topic: robots.odometry(time_ns, 0, reading.odometry),
        inputs.truth.topic: robots.ground_truth(time_ns, 0, reading),
        inputs.scan.topic: robots.scan(time_ns, 0, robot.laser, reading.ranges_m),
        inputs.contact.topic: robots.contact(time_ns, 0, reading.in_contact, reading.contact_angles_rad),
    }
    for sensor in robot.sensors:
        if sensor.name in reading.sensors:
            sent[f"/robot_0/{sensor.name}"] = sensor.message(time_ns, 0, reading.sensors[sensor.name])
    topics = {
        one.topic: one for one in (inputs.odometry, inputs.truth, inputs.scan, inputs.contact, *inputs.additional)
    }
    assert topics.keys() >= sent.keys()
    return {name: topics[name].decode(received(topics[name].type_name, message)) for name, message in sent.items()}


def received(type_name, message):
    return message_type(type_name).decode(message_type(type_name).encode(message))


def test_readings_from_topics_are_those_of_the_headless_run_to_the_bit(course):
    inputs, steps = course
    for _, expected, values in steps:
        reading = inputs.reading(values)
        for key in ("ground_truth", "twist", "odometry", "in_contact", "contact_angles_rad"):
            assert getattr(reading, key) == getattr(expected, key), key
        assert np.array_equal(reading.ranges_m, expected.ranges_m)
        assert reading.sensors.keys() == expected.sensors.keys()
        for name, value in expected.sensors.items():
            if isinstance(value, np.ndarray):
                assert reading.sensors[name].dtype == np.float32
                assert np.array_equal(reading.sensors[name], value)
            else:
                assert reading.sensors[name] == value
    assert sum("fix" in expected.sensors for _, expected, _ in steps) == 9
    assert sum("rear" in expected.sensors for _, expected, _ in steps) == 8


def test_sensor_is_waited_for_exactly_when_it_measures(course):
    inputs, steps = course
    assert len(inputs.additional) == 5
    for stamp_ns, _, values in steps:
        for one in inputs.additional:
            assert one.is_due(stamp_ns) == (one.topic in values)


def test_robot_without_truth_or_contact_has_its_odometry(course):
    inputs, steps = course
    _, expected, values = steps[0]
    reading = inputs.reading({inputs.odometry.topic: values[inputs.odometry.topic]})
    assert reading.ground_truth == reading.odometry.pose == expected.odometry.pose
    assert not reading.in_contact


def test_robot_without_additional_sensors_needs_no_topics():
    scenario = load("tutorial_arena")
    inputs = RobotInputs(Ros1Node(), Settings(scenario), 0)
    assert inputs.additional == []
    assert inputs.reading({inputs.odometry.topic: STILL}).sensors == {}
