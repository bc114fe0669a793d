"""Topics in ROS 2: all of them, their types and qualities of service, and the messages of each step."""

from __future__ import annotations

import itertools
import math
import shlex
from pathlib import Path

import pytest
from own_package import SENSORS, TYPE, install
from peer import ALL, ALL_LATCHED, MISSION, Peer
from rclpy.qos import DurabilityPolicy, ReliabilityPolicy
from running import running

from robotteamsim.recording.bag import BagMessages
from robotteamsim.recording.bag_types import ROS2, bag_typestore, message_type
from robotteamsim.scenario import load
from robotteamsim.scenario.map_image import published_map
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation

OVERRIDES = ("run.seed=7", "robots.sensors=[{kind: sonar, name: front}]")
PAUSED = (*MISSION, "garage_sar", "--controllers", "inside", "--paused", "--speed", "0")
BAG = ("--localization", "none")
"""As in bags, tf has no map -> odom."""
STEPS = 30


@pytest.fixture
def paused(tmp_path, peer):
    """A mission that is paused before its first step."""
    overrides = itertools.chain(*(("--set", override) for override in OVERRIDES))
    with running((*PAUSED, *BAG, *overrides), tmp_path) as mission:
        peer.wait_until(lambda: peer.node.count_publishers("/clock"), "the simulation")
        yield mission


def step(peer: Peer) -> None:
    answer = peer.call("/simulation/step", "robotteamsim/Step", steps=1)
    assert answer.success, answer.message


def test_all_topics_of_a_bag_are_there_with_their_types_and_qualities_of_service(paused, peer):
    headless, store = list(BagMessages(resolve(load("garage_sar", OVERRIDES))).topics()), bag_typestore(ROS2)
    wanted = {topic.name: topic.type_name.replace("/", "/msg/") for topic in headless}
    peer.wait_until(lambda: wanted.keys() <= dict(peer.node.get_topic_names_and_types()).keys(), "all topics")
    types = dict(peer.node.get_topic_names_and_types())
    assert {name: types[name] for name in wanted} == {name: [type_name] for name, type_name in wanted.items()}
    for topic in headless:
        (info,) = peer.node.get_publishers_info_by_topic(topic.name)
        assert info.node_name == "simulation"
        assert info.qos_profile.reliability == ReliabilityPolicy.RELIABLE
        # The definitions in MCAP files are those of the nodes, to every name and type.
        assert str(info.topic_type_hash) == store.hash_rihs01(info.topic_type), topic.name
        latched = info.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
        assert latched == topic.latched, topic.name


def test_messages_of_each_step_are_the_bytes_of_an_mcap_file(paused, peer):
    setup = resolve(load("garage_sar", OVERRIDES))
    contents = BagMessages(setup)
    # A bag has the latched ones only when they change.
    topics = [topic for topic in contents.topics() if not topic.latched]
    received = {topic.name: peer.listen(topic.name, topic.type_name, raw=True) for topic in topics}
    steps = peer.listen("/network/state", "robotteamsim/NetworkState")
    for topic in topics:
        peer.wait_until(lambda name=topic.name: peer.node.get_publishers_info_by_topic(name), topic.name)
    simulation, expected = Simulation(setup), {topic.name: [] for topic in topics}
    types = {topic.name: topic.type_name for topic in topics}
    for number in range(STEPS):
        step(peer)
        peer.wait_until(lambda: len(steps) > number, f"step {number}")  # noqa: B023
        for _, name, message in contents.of_step(simulation.step()):
            if name in expected:
                expected[name].append(message_type(types[name], ROS2).encode(message))
    compared = 0
    for name, wanted in expected.items():
        peer.wait_until(lambda: len(received[name]) >= len(wanted), name)  # noqa: B023
        got, sent = ([unpadded(types[name], data) for data in some] for some in (received[name], wanted))
        assert got == sent, name
        compared += len(sent)
    assert compared > 20 * STEPS


def test_sonar_arrives_complete_as_the_installed_type(paused, peer):
    """In Humble a sensor_msgs/Range ends with the range, later with a variance."""
    ranges = peer.listen("/robot_0/front", "sensor_msgs/Range")
    peer.wait_until(lambda: peer.node.count_publishers("/robot_0/front"), "the sonar")
    simulation = Simulation(load("garage_sar", OVERRIDES))
    for number in range(3):
        step(peer)
        peer.wait_until(lambda: len(ranges) > number, f"step {number}")  # noqa: B023
        expected = simulation.step().readings[0].sensors["front"]
        assert ranges[-1].range == pytest.approx(expected)
        assert getattr(ranges[-1], "variance", 0.0) == 0.0


def unpadded(type_name: str, data: bytes) -> bytes:
    """Return the bytes of a message without what pads them."""
    store, name = bag_typestore(ROS2), type_name.replace("/", "/msg/")
    return bytes(store.serialize_cdr(store.deserialize_cdr(data, name), name))


def test_late_subscriber_gets_the_map_and_the_status_of_the_mission(paused, peer):
    step(peer)
    maps = peer.listen("/map", "nav_msgs/OccupancyGrid", ALL_LATCHED)
    states = peer.listen("/mission/status", "robotteamsim/MissionStatus", ALL_LATCHED)
    peer.wait_until(lambda: maps and states, "latched messages")
    assert (maps[0].info.width, maps[0].info.height) == tuple(published_map(load("garage_sar")).cells.shape[::-1])
    assert states[-1].state == "running"


def test_tf_is_there_with_prefix_for_the_team_and_without_for_each_robot(paused, peer):
    team, own = peer.listen("/tf", "tf2_msgs/TFMessage"), peer.listen("/robot_1/tf", "tf2_msgs/TFMessage")
    fixed = peer.listen("/robot_1/tf_static", "tf2_msgs/TFMessage", ALL_LATCHED)
    peer.wait_until(lambda: fixed, "/robot_1/tf_static")
    while not (team and own):
        step(peer)
    links = {(link.header.frame_id, link.child_frame_id) for link in team[-1].transforms}
    assert {("robot_1/odom", "robot_1/base_footprint"), ("robot_2/base_link", "robot_2/base_laser_link")} <= links
    assert [(link.header.frame_id, link.child_frame_id) for link in own[-1].transforms] == [("odom", "base_footprint")]
    assert [(link.header.frame_id, link.child_frame_id) for link in fixed[-1].transforms] == [
        ("base_footprint", "base_link"),
        ("base_link", "base_laser_link"),
        ("base_link", "front_link"),
    ]


def test_tf_leads_from_the_map_to_each_robot_unless_another_node_locates_it(tmp_path, peer):
    with running(PAUSED, tmp_path):
        own = peer.listen("/robot_1/tf", "tf2_msgs/TFMessage")
        while not own:
            step(peer)
    links = [(link.header.frame_id, link.child_frame_id) for link in own[-1].transforms]
    assert links == [("map", "odom"), ("odom", "base_footprint")]


def test_start_for_nav2_leaves_the_map_to_it_and_sends_infinity_for_no_return(tmp_path, peer):
    page = (Path(__file__).parents[2] / "docs" / "ros2.md").read_text()
    command = page.partition("## nav2 and slam_toolbox")[2].partition("```sh\n")[2].partition("```")[0]
    start = shlex.split(command)
    assert start[:3] == ["python3", *MISSION[1:]]
    with running((*MISSION, *start[3:]), tmp_path):
        transforms = peer.listen("/tf", "tf2_msgs/TFMessage")
        scans = peer.listen("/robot_0/base_scan", "sensor_msgs/LaserScan")
        peer.wait_until(lambda: len(transforms) > 5 and len(scans) > 5, "some steps")
    assert "map" not in {one.header.frame_id for message in transforms for one in message.transforms}
    scan = scans[-1]
    assert max(one for one in scan.ranges if math.isfinite(one)) < scan.range_max
    assert math.inf in scan.ranges
    assert scan.scan_time == pytest.approx(0.1)


def test_clock_shows_the_time_to_nodes_with_simulated_time(paused, peer):
    clock = peer.listen("/clock", "rosgraph_msgs/Clock", ALL)
    while not clock:
        step(peer)
    peer.wait_until(lambda: clock[-1].clock.sec * 10**9 + clock[-1].clock.nanosec >= 10**8, "the end of a step")


def test_sensor_of_a_users_package_is_on_its_topic(tmp_path, peer, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", install(tmp_path)["PYTHONPATH"])
    with running((*PAUSED, "--set", SENSORS), tmp_path):
        arrays = peer.listen("/robot_1/others", TYPE)
        peer.wait_until(lambda: peer.node.count_publishers("/robot_1/others"), "the sensor")
        step(peer)
        peer.wait_until(lambda: arrays, "a reading")
    assert len(arrays[0].poses) == 2
