"""Additional sensors in the bag of a real, short run."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag1 import Reader

from robotteamsim.recording import BagWriter
from robotteamsim.recording.bag_types import bag_typestore
from robotteamsim.scenario.sections import Mission, PlacedRobot
from robotteamsim.scenario.sensors import Gps, MountedLaser, Sonar
from robotteamsim.simulation import Observer, Simulation, StepRecord

STEPS = 10
REAR = MountedLaser(name="rear", yaw_rad=2.0, beams=9, noise_m=0.01)
SIDE = Sonar(name="side", yaw_rad=1.5, opening_rad=0.25, noise_m=0.01, range_max_m=8.0)
GPS = Gps(datum_lat_deg=40.0, datum_lon_deg=-8.0, noise_m=0.5, rate_hz=5.0)
SLOW = MountedLaser(name="slow", every_steps=3, beams=5)


class Memory(Observer):
    """Keeps the records of a run."""

    def begin(self, scenario: object) -> None:
        self.records: list[StepRecord] = []

    def step(self, record: StepRecord) -> None:
        self.records.append(record)


@pytest.fixture
def recorded(hall_scenario, tmp_path) -> tuple[list[StepRecord], dict[str, list]]:
    """The records of a run, and the messages of its bag by topic."""
    scenario = hall_scenario(
        robots=(
            PlacedRobot(start_pose=(3.0, 4.0, 0.0), sensors=(REAR, SLOW, SIDE, GPS)),
            PlacedRobot(start_pose=(3.0, 4.4, 0.0)),
        ),
        mission=Mission(time_limit_s=0.1 * STEPS),
    )
    path, memory = tmp_path / "run.bag", Memory()
    Simulation(scenario).run([BagWriter(path), memory])
    return memory.records, messages(path)


def messages(path: Path) -> dict[str, list]:
    typestore, found = bag_typestore(), {}
    with Reader(path) as reader:
        for connection, _, data in reader.messages():
            found.setdefault(connection.topic, []).append(typestore.deserialize_ros1(data, connection.msgtype))
    return found


def stamps_ns(of_topic: list) -> list[int]:
    return [message.header.stamp.sec * 10**9 + message.header.stamp.nanosec for message in of_topic]


def test_additional_scans_are_in_the_bag_in_the_steps_that_have_them(recorded):
    records, bag = recorded
    rear = [record.readings[0].sensors["rear"] for record in records]
    np.testing.assert_array_equal([message.ranges for message in bag["/robot_0/rear"]], rear)
    assert stamps_ns(bag["/robot_0/rear"]) == [record.sim_time_ns for record in records]
    assert stamps_ns(bag["/robot_0/slow"]) == [record.sim_time_ns for record in records if record.step_index % 3 == 0]
    message = bag["/robot_0/rear"][0]
    assert message.header.frame_id == "robot_0/rear_link"
    assert message.angle_min + 8 * message.angle_increment == pytest.approx(message.angle_max)
    assert not {"/robot_1/rear", "/robot_1/slow"} & bag.keys()


def test_scans_have_the_time_between_them(recorded):
    _, bag = recorded
    for topic, seconds in (("base_scan", 0.1), ("rear", 0.1), ("slow", 0.3)):
        assert {message.scan_time for message in bag[f"/robot_0/{topic}"]} == {float(np.float32(seconds))}


def test_frames_of_additional_sensors_are_in_the_bag(recorded):
    _, bag = recorded
    for message in bag["/tf"]:
        children = [link.child_frame_id for link in message.transforms if link.header.frame_id == "robot_0/base_link"]
        assert children == [f"robot_0/{name}_link" for name in ("base_laser", "rear", "slow", "side")]


def test_sonars_are_in_the_bag_as_ranges_of_ultrasound(recorded):
    records, bag = recorded
    of_topic = bag["/robot_0/side"]
    assert [message.range for message in of_topic] == [record.readings[0].sensors["side"] for record in records]
    assert len({message.range for message in of_topic}) == len(records)
    message = of_topic[0]
    assert message.radiation_type == message.ULTRASOUND
    limits = (message.field_of_view, message.min_range, message.max_range)
    assert limits == tuple(map(float, np.float32([0.25, 0.02, 8.0])))
    assert message.header.frame_id == "robot_0/side_link"


def test_directions_of_contacts_are_in_the_bag(recorded):
    records, bag = recorded
    for robot_id in (0, 1):
        readings = [record.readings[robot_id] for record in records]
        messages = bag[f"/robot_{robot_id}/contact"]
        assert [tuple(message.angles_rad) for message in messages] == [r.contact_angles_rad for r in readings]
        assert [len(message.angles_rad) > 0 for message in messages] == [r.in_contact for r in readings]
        assert any(r.in_contact for r in readings)


def test_fixes_are_in_the_bag_in_the_steps_that_have_them(recorded):
    records, bag = recorded
    fixes = [record.readings[0].sensors["fix"] for record in records if record.step_index % 2 == 0]
    messages = bag["/robot_0/fix"]
    assert [(m.latitude, m.longitude, m.altitude) for m in messages] == [
        (fix.latitude_deg, fix.longitude_deg, fix.altitude_m) for fix in fixes
    ]
    message = messages[0]
    assert (message.status.status, message.status.service) == (message.status.STATUS_FIX, message.status.SERVICE_GPS)
    assert message.position_covariance.tolist() == [0.25, 0.0, 0.0, 0.0, 0.25, 0.0, 0.0, 0.0, 0.0]
    assert message.position_covariance_type == message.COVARIANCE_TYPE_DIAGONAL_KNOWN
    assert message.header.frame_id == "robot_0/base_link"
