"""Messages become the bytes that another library, rosbags, makes of the same values, and are read as it reads them."""

from __future__ import annotations

import contextlib
import math
import re
from dataclasses import fields, is_dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from robotteamsim.message_parts import header
from robotteamsim.recording.bag import BagMessages
from robotteamsim.recording.bag_types import ROS1, ROS2, bag_typestore, message_type
from robotteamsim.rng import stream
from robotteamsim.scenario import load
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation

SENSORS = "[{kind: gps, datum_lat_deg: 40, datum_lon_deg: -8}, {kind: sonar, name: front}, {kind: laser, name: rear}]"
STEPS = 12
NOTHING = "structure_needs_at_least_one_member"
LEFT_OUT = re.compile(rf"[A-Z][A-Z0-9_]+|__msgtype__|{NOTHING}")
"""Constants, and what rosbags adds."""
VERSIONS = pytest.mark.parametrize("ros", [ROS1, ROS2], ids=["ROS 1", "ROS 2"])


def read_by_rosbags(type_name, data, ros=ROS1):
    store, name = bag_typestore(ros), type_name.replace("/", "/msg/")
    return store.deserialize_ros1(data, name) if ros is ROS1 else store.deserialize_cdr(data, name)


def plain(value):
    """A message of any library as nested tuples; times as nanoseconds, names in lower case."""
    if isinstance(value, np.ndarray):
        return value.dtype, value.tolist()
    if isinstance(value, list):
        return tuple(map(plain, value))
    if hasattr(value, "nanosec"):
        return value.sec * 10**9 + value.nanosec
    if is_dataclass(value) or isinstance(value, SimpleNamespace):
        names = [one.name for one in fields(value)] if is_dataclass(value) else vars(value)
        return {name.lower(): plain(getattr(value, name)) for name in names if not LEFT_OUT.fullmatch(name)}
    return value


def written_by_rosbags(type_name, data, ros):
    """The bytes that rosbags makes of what it reads in others."""
    store, name = bag_typestore(ros), type_name.replace("/", "/msg/")
    message = read_by_rosbags(type_name, data, ros)
    return bytes(store.serialize_ros1(message, name) if ros is ROS1 else store.serialize_cdr(message, name))


@VERSIONS
@pytest.mark.parametrize(
    ("name", "overrides"),
    [
        ("garage_sar", [f"robots.sensors={SENSORS}"]),
        ("garage_rescue", []),
        ("office_fire", []),
        ("warehouse_push", []),
    ],
)
def test_all_messages_of_a_mission_are_the_bytes_that_rosbags_writes(name, overrides, ros):
    setup = resolve(load(name, overrides))
    contents, simulation, seen = BagMessages(setup, localized=True), Simulation(setup), set()
    types = {topic.name: topic.type_name for topic in contents.topics()}
    for _ in range(STEPS):
        for _, topic, message in contents.of_step(simulation.step()):
            data = message_type(types[topic], ros).encode(message)
            assert written_by_rosbags(types[topic], data, ros) == data, topic
            read = message_type(types[topic], ros).decode(data)
            assert repr(plain(read)) == repr(plain(read_by_rosbags(types[topic], data, ros))), topic
            seen.add(types[topic])
    assert len(seen) > 10


@VERSIONS
def test_message_without_attributes_is_the_default_of_every_type(ros):
    for name in bag_typestore(ros).fielddefs:
        package, _, kind = name.partition("/msg/")
        if package == "builtin_interfaces":
            continue
        of_type = message_type(f"{package}/{kind}", ros)
        data = of_type.encode({})
        assert written_by_rosbags(f"{package}/{kind}", data, ros) == data, name
        assert plain(of_type.decode(data)) == plain(read_by_rosbags(f"{package}/{kind}", data, ros)), name


@VERSIONS
def test_numbers_and_texts_arrive_as_they_are(ros):
    stamp_ns = 1_700_000_000_123_456_789
    covariance = np.arange(36.0)
    odometry = {
        "header": header(stamp_ns, "mäp"),
        "pose": {"pose": {"position": {"x": 0.1 + 0.2, "y": -0.0, "z": math.inf}}, "covariance": covariance},
        "twist": {"covariance": covariance.reshape(6, 6).tolist()[0] * 6},
    }
    message = read_by_rosbags("nav_msgs/Odometry", message_type("nav_msgs/Odometry", ros).encode(odometry), ros)
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == divmod(stamp_ns, 10**9)
    assert message.header.frame_id == "mäp"
    place = message.pose.pose.position
    assert (place.x, math.copysign(1.0, place.y), place.z) == (0.1 + 0.2, -1.0, math.inf)
    assert message.pose.covariance.tolist() == covariance.tolist()
    assert message.twist.covariance.tolist() == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0] * 6
    status = {"victims": ["ann", "", "böb"], "explored": (True, False), "target_area": -1, "explored_by": [-(2**31), 7]}
    of_status = message_type("robotteamsim/MissionStatus", ros)
    message = read_by_rosbags("robotteamsim/MissionStatus", of_status.encode(status), ros)
    assert plain(of_status.decode(of_status.encode(status))) == plain(message)
    assert message.victims == ["ann", "", "böb"]
    assert message.explored.tolist() == [1, 0]
    assert (message.target_area, message.explored_by.tolist()) == (-1, [-(2**31), 7])


def test_arrays_of_any_type_and_layout_are_converted():
    cells = np.arange(12, dtype=np.int64).reshape(3, 4)
    grid, picture = message_type("nav_msgs/OccupancyGrid"), message_type("sensor_msgs/Image")
    for data in (cells.astype(np.int8), cells[0], cells[:, 0], cells[0].tolist(), tuple(cells[0].tolist())):
        assert grid.decode(grid.encode({"data": data})).data.tolist() == np.ravel(data).tolist()
    assert picture.decode(picture.encode({"data": b"\x00\xff"})).data.tolist() == [0, 255]


@pytest.mark.parametrize(
    ("type_name", "message", "line"),
    [
        ("nav_msgs/Odometry", {"child_frame": "a"}, "nav_msgs/Odometry has no attribute 'child_frame'"),
        ("nav_msgs/Odometry", {"child_frame_id": 3}, "nav_msgs/Odometry.child_frame_id: 3"),
        (
            "nav_msgs/Odometry",
            {"pose": {"covariance": [1.0]}},
            "geometry_msgs/PoseWithCovariance.covariance: 1 value",
        ),
        ("nav_msgs/Odometry", {"pose": [1.0]}, "geometry_msgs/PoseWithCovariance: expected a dict"),
        ("sensor_msgs/LaserScan", {"ranges": 3.0}, "sensor_msgs/LaserScan.ranges: 3.0"),
        ("sensor_msgs/LaserScan", {"angle_min": 1e39}, "sensor_msgs/LaserScan.angle_min: a number that is too large"),
        ("sensor_msgs/Image", {"height": -1}, "sensor_msgs/Image.height: a number that is too large or too small"),
        ("sensor_msgs/Image", {"height": 1.5}, "sensor_msgs/Image.height: 1.5"),
        ("nav_msgs/OccupancyGrid", {"data": [200]}, "nav_msgs/OccupancyGrid.data: a number that is too large"),
        ("std_msgs/Header", {"stamp": 2**32 * 10**9}, "std_msgs/Header.stamp: a time too late"),
        ("robotteamsim/Areas", {"areas": [{"name": 1}]}, "robotteamsim/Area.name: 1"),
    ],
)
def test_what_a_type_cannot_hold_is_refused_with_its_name(type_name, message, line):
    with pytest.raises((ValueError, TypeError), match=f"^{line}"):
        message_type(type_name).encode(message)


FULL = {
    "nav_msgs/Odometry": {"child_frame_id": "base", "header": header(5, "odom")},
    "sensor_msgs/LaserScan": {"ranges": [1.0, 2.0, 3.0], "intensities": [4.0]},
    "robotteamsim/MissionStatus": {"victims": ["ann", "bob"], "explored": [True], "undelivered": [{"name": "a"}]},
    "tf2_msgs/TFMessage": {"transforms": [{"child_frame_id": "a"}, {"header": header(1, "map")}]},
}


@VERSIONS
@pytest.mark.parametrize("type_name", FULL)
def test_bytes_that_are_too_few_or_too_many_are_refused(type_name, ros):
    of_type = message_type(type_name, ros)
    data = of_type.encode(FULL[type_name])
    for length in range(len(data)):
        with pytest.raises(ValueError, match=f"^not a {type_name}: too short$"):
            of_type.decode(data[:length])
    with pytest.raises(ValueError, match=f"^not a {type_name}: too long$"):
        of_type.decode(data + bytes(8))
    if ros is ROS2:  # whose middlewares fill up the last four bytes
        assert plain(of_type.decode(data + bytes(3))) == plain(of_type.decode(data))


@VERSIONS
def test_damaged_bytes_are_read_or_refused(ros):
    generator = stream(7, "damaged")
    for type_name, message in FULL.items():
        of_type = message_type(type_name, ros)
        data = np.frombuffer(of_type.encode(message), np.uint8)
        for _ in range(500):
            damaged = data.copy()
            damaged[generator.integers(0, len(data), 3)] = generator.integers(0, 256, 3)
            with contextlib.suppress(ValueError):
                of_type.decode(damaged.tobytes())


def test_message_of_a_big_endian_computer_is_read():
    of_type = message_type("sensor_msgs/LaserScan", ROS2)
    message = read_by_rosbags("sensor_msgs/LaserScan", of_type.encode(FULL["sensor_msgs/LaserScan"]), ROS2)
    data = bytes(bag_typestore(ROS2).serialize_cdr(message, "sensor_msgs/msg/LaserScan", little_endian=False))
    assert data[1] == 0
    assert of_type.decode(data).ranges.tolist() == [1.0, 2.0, 3.0]
