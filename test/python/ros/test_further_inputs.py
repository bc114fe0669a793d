from __future__ import annotations

import numpy as np
import pytest

from robotteamsim.geometry import Twist
from robotteamsim.recording.sensor_messages import sensor_topics
from robotteamsim.ros.nodes.further_inputs import FurtherInputs
from robotteamsim.ros.transport.msg_conversion import RosTypes
from robotteamsim.ros.transport.serialization import deserialized, serialized
from robotteamsim.ros.transport.synchronizer import Step
from robotteamsim.scenario import load
from robotteamsim.sensing.readings import NOTHING_FURTHER
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.world import World
from robotteamsim.world.placement import placed_robots

EQUIPPED = (
    "robots.lasers=[{name: rear, yaw_rad: 3.1416, beams: 31, noise_m: 0.01, every_steps: 3}, {name: left, beams: 7}]",
    "robots.sonars=[{name: sonar_0, noise_m: 0.02}, {name: sonar_1, yaw_rad: 1.5}]",
    "robots.gps={datum_lat_deg: 40.186, datum_lon_deg: -8.416, rate_hz: 4}",
)


@pytest.fixture
def readings():
    """Return the inputs of a robot, and for each step its stamp, readings without ROS, and messages as received."""
    scenario = load("tutorial_arena", EQUIPPED)
    robots = placed_robots(scenario)
    world = World(scenario.plan, robots, scenario.run)
    sensors = RobotSensors(world, robots, 3)
    inputs = FurtherInputs(robots[0], "/robot_0/", scenario.run.step_ns)
    decoders = {an_input.channel.name: an_input.decode for an_input in inputs.inputs}
    steps = []
    for _ in range(24):
        world.step([Twist(0.3, 0.0, 0.2)])
        further = sensors.read()[0].further
        messages = {
            f"/robot_0/{topic.name}": topic.message(RosTypes(), world.sim_time_ns, 0, further)
            for topic in sensor_topics(robots[0])
        }
        received = {
            name: () if message is None else (decoded(message, decoders[name]),) for name, message in messages.items()
        }
        steps.append((world.sim_time_ns, further, received))
    return inputs, steps


def decoded(message, decode):
    """Return a message as a node receives it."""
    data = serialized(message)
    return deserialized(type(message), data) if decode is None else decode(data)


def test_readings_from_topics_are_those_of_the_headless_run_to_the_bit(readings):
    inputs, steps = readings
    for stamp_ns, further, messages in steps:
        reading = inputs.reading(Step(stamp_ns, False, messages))
        for key in set(further.__struct_fields__) - {"scans_m"}:
            assert getattr(reading, key) == getattr(further, key), key
        for one, other in zip(reading.scans_m, further.scans_m, strict=True):
            assert (one is None) == (other is None)
            assert one is None or (one.dtype == np.float32 and np.array_equal(one, other))
    assert sum(further.fix is not None for _, further, _ in steps) == 9
    assert sum(further.scans_m[0] is not None for _, further, _ in steps) == 8


def test_a_sensor_is_waited_for_exactly_when_it_measures(readings):
    inputs, steps = readings
    dues = {an_input.channel.name: an_input.channel.due for an_input in inputs.inputs}
    assert len(dues) == 5
    for stamp_ns, _, messages in steps:
        for name, due in dues.items():
            assert (due is None or due(stamp_ns)) == bool(messages[name])


def test_sonar_that_is_late_keeps_its_last_range(readings):
    inputs, steps = readings
    nothing = dict.fromkeys(steps[0][2], ())
    assert inputs.reading(Step(100_000_000, False, nothing)).sonars_m == (3.0, 3.0)
    stamp_ns, further, messages = steps[0]
    inputs.reading(Step(stamp_ns, False, messages))
    assert inputs.reading(Step(200_000_000, False, nothing)).sonars_m == further.sonars_m
    inputs.restart()
    assert inputs.reading(Step(300_000_000, False, nothing)).sonars_m == (3.0, 3.0)


def test_robot_without_further_sensors_needs_no_topics():
    robot = placed_robots(load("tutorial_arena"))[0]
    inputs = FurtherInputs(robot, "", 100_000_000)
    assert inputs.inputs == []
    assert inputs.reading(Step(100_000_000, False, {})) is NOTHING_FURTHER
