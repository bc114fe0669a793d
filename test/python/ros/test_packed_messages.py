from __future__ import annotations

from io import BytesIO
from typing import Any

import numpy as np
import pytest
from nav_msgs.msg import Odometry
from robotteamsim.msg import Contact, MissionStatus
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Header
from tf2_msgs.msg import TFMessage

from robotteamsim.geometry import PoseReading
from robotteamsim.recording import ros_messages
from robotteamsim.ros.nodes import team_outputs
from robotteamsim.ros.transport.msg_conversion import RosTypes
from robotteamsim.ros.transport.packed_messages import PackedRows, Serialized, layout
from robotteamsim.scenario.sections import Laser, PlacedRobot
from robotteamsim.sensing.readings import TeamReadings

MAKE = RosTypes()
TIME_NS = 12_345_678_901
ROBOTS = 12
"""Names of robots have two lengths then."""


def serialized(message: Any) -> bytes:
    buffer = BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


def on_the_wire(message: Any) -> bytes:
    data = serialized(message)
    return len(data).to_bytes(4, "little") + data


@pytest.mark.parametrize(
    "message",
    [
        LaserScan(header=Header(frame_id="robot_7/base_laser_link"), ranges=[1.0] * 5, intensities=[2.0] * 3),
        Odometry(child_frame_id="ä"),
        MissionStatus(scenario="x", explored=b"\x01\x00"),
        TFMessage(transforms=[ros_messages.localization(MAKE, 0, i, PoseReading(1.0, 2.0, 0.0, 1.0)) for i in (9, 10)]),
    ],
    ids=lambda message: type(message).__name__,
)
def test_layout_is_as_long_as_the_message(message):
    assert np.dtype(layout(message)).itemsize == len(serialized(message))


def test_fields_that_are_set_are_those_that_ros_reads():
    rows = PackedRows([[Contact(header=Header(frame_id=f"robot_{i}"))] for i in range(ROBOTS)], with_length=True)
    hits = np.arange(ROBOTS) % 3 == 0
    rows.set("0.in_contact", hits)
    rows.stamp(TIME_NS, 7)
    for robot_id, row in enumerate(rows.rows):
        message = Contact().deserialize(bytes(row[4:]))
        assert int.from_bytes(row[:4], "little") == len(row) - 4
        assert (message.in_contact, message.header.seq) == (hits[robot_id], 7)
        assert (message.header.frame_id, message.header.stamp.to_nsec()) == (f"robot_{robot_id}", TIME_NS)


def test_unknown_field_is_refused():
    rows = PackedRows([[Contact()]], with_length=True)
    with pytest.raises(ValueError, match="no field of name in_touch"):
        rows.set("0.in_touch", np.array([True]))


def test_late_subscriber_gets_the_bytes_as_they_were():
    data = serialized(Contact(in_contact=True))
    assert serialized(Serialized(data)) == data


class Wire:
    """Keeps the bytes that each topic sends."""

    sent: dict[str, bytes]
    heard = True

    def __init__(self, topic: str, message_class: type, *, latched: bool = False) -> None:
        self._topic = topic
        self.wanted = Wire.heard
        self.num_subscribers = 1

    def publish_bytes(self, data: memoryview) -> None:
        if self.wanted:
            Wire.sent[self._topic] = bytes(data)


@pytest.fixture
def wire(monkeypatch) -> type[Wire]:
    monkeypatch.setattr(team_outputs, "Output", Wire)
    monkeypatch.setattr(Wire, "sent", {}, raising=False)
    monkeypatch.setattr(Wire, "heard", True)
    return Wire


@pytest.fixture
def robots() -> list[PlacedRobot]:
    """Robots with two kinds of lasers."""
    lasers = (Laser(), Laser(beams=7, forward_m=0.1))
    return [PlacedRobot(start_pose=(float(i), 0.0, 0.0), laser=lasers[i % 5 == 0]) for i in range(ROBOTS)]


@pytest.fixture
def readings(robots) -> TeamReadings:
    generator = np.random.default_rng(5)
    angles = generator.uniform(-3.0, 3.0, (ROBOTS, 1))
    odometry = np.hstack((generator.normal(size=(ROBOTS, 2)), np.sin(angles), np.cos(angles)))
    positions_m = generator.normal(size=(ROBOTS, 2))
    return TeamReadings(
        ground_truth=np.hstack((positions_m, np.sin(-angles), np.cos(-angles))),
        positions_m=positions_m,
        twists=generator.normal(size=(ROBOTS, 3)),
        odometry=np.hstack((odometry, generator.normal(size=(ROBOTS, 12)))),
        ranges_m=[generator.uniform(0.1, 5.0, robot.laser.beams).astype(np.float32) for robot in robots],
        in_contact=np.arange(ROBOTS) % 4 > 1,
        contact_angles_rad={2: (0.5,), 3: (-1.0, 1.0), 11: (3.0,)},
    )


def numbered(message: Any) -> Any:
    """Give a message the number that the first step has."""
    message.header.seq = 1
    return message


def test_robots_topics_carry_the_bytes_that_rospy_makes_of_their_fields(wire, robots, readings):
    outputs = team_outputs.TeamOutputs(robots, latched=False, localized=False)
    outputs.publish(TIME_NS, readings)
    for i, (robot, reading) in enumerate(zip(robots, readings, strict=True)):
        wanted = {
            "odom": ros_messages.odometry(MAKE, TIME_NS, i, reading.odometry),
            "base_pose_ground_truth": ros_messages.ground_truth(MAKE, TIME_NS, i, reading),
            "base_scan": ros_messages.scan(MAKE, TIME_NS, i, robot.laser, reading.ranges_m),
            "contact": ros_messages.contact(MAKE, TIME_NS, i, reading.in_contact, reading.contact_angles_rad),
        }
        for name, message in wanted.items():
            assert wire.sent[f"/robot_{i}/{name}"] == on_the_wire(numbered(message)), (i, name)


@pytest.mark.parametrize("localized", [False, True])
def test_tf_carries_the_bytes_that_rospy_makes_of_its_fields(wire, robots, readings, localized):
    team_outputs.TeamOutputs(robots, latched=False, localized=localized).publish(TIME_NS, readings)
    message = ros_messages.transforms(MAKE, TIME_NS, robots, [reading.odometry for reading in readings])
    if localized:
        message.transforms += [
            ros_messages.localization(
                MAKE, TIME_NS, i, PoseReading.from_pose(r.ground_truth.pose @ r.odometry.pose.pose.inverse())
            )
            for i, r in enumerate(readings)
        ]
    assert wire.sent["/tf"] == on_the_wire(message)


def test_step_leaves_nothing_of_the_step_before(wire, robots, readings):
    outputs = team_outputs.TeamOutputs(robots, latched=False, localized=False)
    outputs.publish(TIME_NS - 100_000_000, readings)
    still = TeamReadings(
        ground_truth=np.zeros((ROBOTS, 4)),
        positions_m=np.zeros((ROBOTS, 2)),
        twists=np.zeros((ROBOTS, 3)),
        odometry=np.zeros((ROBOTS, 16)),
        ranges_m=[np.zeros_like(ranges_m) for ranges_m in readings.ranges_m],
        in_contact=np.zeros(ROBOTS, bool),
    )
    outputs.publish(TIME_NS, still)
    message = ros_messages.odometry(MAKE, TIME_NS, 11, still[11].odometry)
    message.header.seq = 2
    assert wire.sent["/robot_11/odom"] == on_the_wire(message)


def test_nothing_is_sent_that_nobody_hears(wire, robots, readings):
    wire.heard = False
    outputs = team_outputs.TeamOutputs(robots, latched=False, localized=True)
    outputs.publish(TIME_NS, readings)
    assert wire.sent == {}
