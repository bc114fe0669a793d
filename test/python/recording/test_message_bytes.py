"""Messages become the bytes that another library, rosbags, makes of the same values, in ROS 1 and in ROS 2."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robotteamsim.message_parts import header
from robotteamsim.recording.bag import BagMessages
from robotteamsim.recording.bag_types import ROS1, ROS2, bag_typestore, decoded, encoder
from robotteamsim.scenario import load
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation

SENSORS = "[{kind: gps, datum_lat_deg: 40, datum_lon_deg: -8}, {kind: sonar, name: front}, {kind: laser, name: rear}]"
STEPS = 12
VERSIONS = pytest.mark.parametrize("ros", [ROS1, ROS2], ids=["ROS 1", "ROS 2"])


def written_by_rosbags(type_name, data, ros):
    """The bytes that rosbags makes of what it reads in others."""
    store, name = bag_typestore(ros), type_name.replace("/", "/msg/")
    message = decoded(type_name, data, ros)
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
            data = encoder(types[topic], ros).encode(message)
            assert written_by_rosbags(types[topic], data, ros) == data, topic
            seen.add(types[topic])
    assert len(seen) > 10


@VERSIONS
def test_message_without_attributes_is_the_default_of_every_type(ros):
    for name in bag_typestore(ros).fielddefs:
        package, _, kind = name.partition("/msg/")
        if package == "builtin_interfaces":
            continue
        data = encoder(f"{package}/{kind}", ros).encode({})
        assert written_by_rosbags(f"{package}/{kind}", data, ros) == data, name


@VERSIONS
def test_numbers_and_texts_arrive_as_they_are(ros):
    stamp_ns = 1_700_000_000_123_456_789
    covariance = np.arange(36.0)
    odometry = {
        "header": header(stamp_ns, "mäp"),
        "pose": {"pose": {"position": {"x": 0.1 + 0.2, "y": -0.0, "z": math.inf}}, "covariance": covariance},
        "twist": {"covariance": covariance.reshape(6, 6).tolist()[0] * 6},
    }
    message = decoded("nav_msgs/Odometry", encoder("nav_msgs/Odometry", ros).encode(odometry), ros)
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == divmod(stamp_ns, 10**9)
    assert message.header.frame_id == "mäp"
    place = message.pose.pose.position
    assert (place.x, math.copysign(1.0, place.y), place.z) == (0.1 + 0.2, -1.0, math.inf)
    assert message.pose.covariance.tolist() == covariance.tolist()
    assert message.twist.covariance.tolist() == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0] * 6
    status = {"victims": ["ann", "", "böb"], "explored": (True, False), "target_area": -1, "explored_by": [-(2**31), 7]}
    message = decoded("robotteamsim/MissionStatus", encoder("robotteamsim/MissionStatus", ros).encode(status), ros)
    assert message.victims == ["ann", "", "böb"]
    assert message.explored.tolist() == [1, 0]
    assert (message.target_area, message.explored_by.tolist()) == (-1, [-(2**31), 7])


def test_arrays_of_any_type_and_layout_are_converted():
    cells = np.arange(12, dtype=np.int64).reshape(3, 4)
    for data in (cells.astype(np.int8), cells[0], cells[:, 0], cells[0].tolist(), tuple(cells[0].tolist())):
        message = decoded("nav_msgs/OccupancyGrid", encoder("nav_msgs/OccupancyGrid").encode({"data": data}))
        assert message.data.tolist() == np.ravel(data).tolist()
    image = decoded("sensor_msgs/Image", encoder("sensor_msgs/Image").encode({"data": b"\x00\xff"}))
    assert image.data.tolist() == [0, 255]


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
        encoder(type_name).encode(message)
