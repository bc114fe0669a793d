from __future__ import annotations

import os
import resource
import shutil
import signal
import subprocess
import sys
import textwrap
from collections import Counter
from pathlib import Path

import cv2
import msgspec
import numpy as np
import pytest
from rosbags.rosbag1 import Reader

from robotteamsim.errors import RecordingError
from robotteamsim.recording import BagWriter, McapWriter
from robotteamsim.recording.bag_reader import BagReader
from robotteamsim.recording.bag_types import bag_typestore
from robotteamsim.scenario import load, load_floor_plan
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation

ROSBAG = shutil.which("rosbag", path="/usr/bin:/opt/ros/noetic/bin")
needs_rosbag = pytest.mark.skipif(ROSBAG is None, reason="ROS's rosbag is not installed")


@pytest.fixture
def bag(trial, tmp_path) -> Path:
    path = tmp_path / "mission.bag"
    trial.play(BagWriter(path), steps=5)
    return path


def messages(path: Path, topic: str) -> list:
    typestore = bag_typestore()
    with Reader(path) as reader:
        chosen = [connection for connection in reader.connections if connection.topic == topic]
        return [
            (time_ns, typestore.deserialize_ros1(data, connection.msgtype))
            for connection, time_ns, data in reader.messages(chosen)
        ]


def test_bag_has_the_topics_and_types_of_a_ros_run(bag):
    with Reader(bag) as reader:
        types = {c.topic: c.msgtype.replace("/msg/", "/") for c in reader.connections}
    of_robot_1 = {topic.removeprefix("/robot_1/"): kind for topic, kind in types.items() if "robot_1" in topic}
    assert (
        of_robot_1.items()
        >= {
            "odom": "nav_msgs/Odometry",
            "base_scan": "sensor_msgs/LaserScan",
            "base_pose_ground_truth": "nav_msgs/Odometry",
            "voice": "robotteamsim/Voice",
            "network/tx": "robotteamsim/NetworkMessages",
            "network/rx": "robotteamsim/NetworkMessages",
            "cmd_vel": "geometry_msgs/Twist",
            "controller/status": "robotteamsim/ControllerStatus",
            "controller/belief": "nav_msgs/OccupancyGrid",
        }.items()
    )
    assert {topic: kind for topic, kind in types.items() if not topic.startswith("/robot_")} == {
        "/clock": "rosgraph_msgs/Clock",
        "/tf": "tf2_msgs/TFMessage",
        "/map": "nav_msgs/OccupancyGrid",
        "/voice_map": "nav_msgs/OccupancyGrid",
        "/voice_map/values": "robotteamsim/FloatMap",
        "/network/links": "robotteamsim/NetworkLinks",
        "/network/state": "robotteamsim/NetworkState",
        "/mission/status": "robotteamsim/MissionStatus",
        "/mission/events": "robotteamsim/MissionEvent",
        "/mission/victims": "robotteamsim/Victims",
        "/mission/areas": "robotteamsim/Areas",
        "/sensor_world": "robotteamsim/SensorWorld",
        "/world/doors": "robotteamsim/Doors",
        "/world/objects": "visualization_msgs/MarkerArray",
        "/world/robots": "robotteamsim/Robots",
    }


def test_bag_counts_one_message_per_step_and_latched_ones_when_they_change(bag):
    with Reader(bag) as reader:
        counts = Counter(connection.topic for connection, _, _ in reader.messages())
    assert counts["/robot_0/odom"] == counts["/tf"] == counts["/mission/status"] == 5
    assert counts["/clock"] == 25  # five ticks per step
    assert counts["/map"] == counts["/mission/areas"] == 1
    assert counts["/voice_map"] == counts["/mission/victims"] == 2
    assert counts["/mission/events"] == counts["/world/robots"] == 1


def test_ground_truth_in_a_bag_has_the_bits_of_the_trial(trial, bag):
    for record, (time_ns, odometry) in zip(
        trial.records(5), messages(bag, "/robot_1/base_pose_ground_truth"), strict=True
    ):
        truth, pose = record.readings[1].ground_truth, odometry.pose.pose
        assert time_ns == record.sim_time_ns
        assert odometry.header.stamp.sec * 10**9 + odometry.header.stamp.nanosec == time_ns
        assert (pose.position.x, pose.position.y) == (truth.x_m, truth.y_m)
        assert (pose.orientation.z, pose.orientation.w) == (truth.qz, truth.qw)
        assert (odometry.header.frame_id, odometry.child_frame_id) == ("map", "robot_1/base_footprint")


def test_odometry_in_a_bag_has_the_covariances_of_the_trial_and_the_truth_has_none(trial, bag):
    for record, (_, odometry) in zip(trial.records(5), messages(bag, "/robot_0/odom"), strict=True):
        reading = record.readings[0].odometry
        pose, twist = (part.covariance.reshape(6, 6) for part in (odometry.pose, odometry.twist))
        in_plane = pose[np.ix_([0, 1, 5], [0, 1, 5])]
        assert in_plane[np.triu_indices(3)].tolist() == list(reading.pose_covariance)
        np.testing.assert_array_equal(pose, pose.T)
        np.testing.assert_array_equal(twist, np.diag([0.01, 0.0, 0.0, 0.0, 0.0, 0.02]))
    _, truth = messages(bag, "/robot_0/base_pose_ground_truth")[-1]
    assert not truth.pose.covariance.any()
    assert not truth.twist.covariance.any()


def test_scan_in_a_bag_carries_the_ranges(trial, bag):
    _, scan = messages(bag, "/robot_0/base_scan")[0]
    np.testing.assert_array_equal(scan.ranges, trial.record(1).readings[0].ranges_m)
    assert scan.header.frame_id == "robot_0/base_laser_link"
    assert scan.angle_min + 180 * scan.angle_increment == pytest.approx(scan.angle_max)


def test_transforms_chain_odom_to_the_laser(bag):
    _, tf = messages(bag, "/tf")[0]
    chain = [(t.header.frame_id, t.child_frame_id) for t in tf.transforms[:3]]
    assert chain == [
        ("robot_0/odom", "robot_0/base_footprint"),
        ("robot_0/base_footprint", "robot_0/base_link"),
        ("robot_0/base_link", "robot_0/base_laser_link"),
    ]
    assert tf.transforms[0].transform.translation.x == pytest.approx(0.05)
    assert tf.transforms[2].transform.translation.z == 0.25


def test_messages_controllers_and_mission_are_in_the_bag(bag):
    _, sent = messages(bag, "/robot_0/network/tx")[0]
    assert [(m.sender, m.receiver, m.payload) for m in sent.messages] == [(0, -1, '{"best": 1.5}')]
    _, status = messages(bag, "/robot_0/controller/status")[0]
    assert (status.excluded, status.has_goal, status.goal.x, status.search_counter) == (False, True, 16.0, 3)
    assert len(status.context) == 0
    _, status = messages(bag, "/robot_1/controller/status")[0]
    assert [(c.activity, c.alpha, c.c4) for c in status.context] == [(0.0, 0.5, 0.9)]
    _, status = messages(bag, "/mission/status")[3]
    assert (status.state, status.victims, list(status.explored)) == ("running", ["saved", "waiting"], [0, 0])
    assert (status.has_area, status.area_center.x, status.epoch) == (True, 16.0, 1)
    ((_, event),) = messages(bag, "/mission/events")
    assert event.detail == "robot 1 saves ann (1 of 2)"
    _, victims = messages(bag, "/mission/victims")[-1]
    assert [(v.name, v.state) for v in victims.victims] == [("ann", "saved"), ("bob", "waiting")]


def test_sensor_world_in_a_bag_has_local_bests_of_controllers_and_true_distances(bag):
    time_ns, world = messages(bag, "/sensor_world")[2]
    assert (time_ns, world.victims) == (300_000_000, ["ann", "bob"])
    first, second = world.robots
    assert (first.robot_id, first.has_local_best, first.value) == (0, True, 2.5)
    assert (first.local_best.x, first.local_best.y) == (3.5, 4.5)
    # From (3.15, 4) to ann at (9, 4), bob at (12, 7) and east at (16, 5); from (3.15, 6) likewise.
    np.testing.assert_allclose(first.victim_distances_m, [5.85, (8.85**2 + 3.0**2) ** 0.5])
    assert (first.area, first.area_distance_m) == (0, pytest.approx((12.85**2 + 1.0) ** 0.5))
    assert (second.robot_id, second.has_local_best, second.value, second.local_best.x) == (1, False, 0.0, 0.0)
    np.testing.assert_allclose(second.victim_distances_m, [(5.85**2 + 2.0**2) ** 0.5, (8.85**2 + 1.0) ** 0.5])
    assert (second.area, second.area_distance_m) == (0, pytest.approx((12.85**2 + 1.0) ** 0.5))


def test_sensor_world_has_no_absent_robot_and_no_area_when_none_is_left(trial, tmp_path):
    record = trial.record(1)
    status = msgspec.structs.replace(record.mission, target_area=-1)
    gone = msgspec.structs.replace(record, present=np.array([False, True]), mission=status)
    writer = BagWriter(tmp_path / "mission.bag")
    writer.begin(trial.setup)
    writer.step(gone)
    writer.end(trial.result(1))
    ((_, world),) = messages(tmp_path / "mission.bag", "/sensor_world")
    (only,) = world.robots
    assert (only.robot_id, only.area) == (1, -1)
    assert np.isnan(only.area_distance_m)


def test_maps_in_a_bag_lie_over_the_plan(bag):
    _, grid = messages(bag, "/map")[0]
    assert (grid.info.width, grid.info.height) == (400, 200)
    assert grid.data[0] == 100
    assert grid.data[100 * 400 + 200] == 0
    _, voices = messages(bag, "/voice_map/values")[0]
    assert (voices.width, voices.height, voices.unit) == (80, 40, "dB")
    np.testing.assert_array_equal(voices.data, np.full(3200, 12.4, dtype=np.float32))
    _, picture = messages(bag, "/voice_map")[0]
    assert set(picture.data) == {12}


def test_victim_who_walks_moves_in_the_bag(tmp_path):
    walk = ["mission.victims.0.path=[[31, 4.5]]", "mission.victims.0.speed_mps=1"]
    path = tmp_path / "walk.bag"
    Simulation(load("garage_sar", ["mission.time_limit_s=3", *walk])).run([BagWriter(path)])
    places = [(time_ns, m.victims[0].position.x) for time_ns, m in messages(path, "/mission/victims")]
    assert places == [(100_000_000, 29.0), (1_000_000_000, 30.0), (2_000_000_000, 31.0)]


def test_bag_of_an_imported_image_has_its_unknown_cells(trial, tmp_path):
    cells = np.full((100, 200), 254, np.uint8)
    cells[[0, -1]] = cells[:, [0, -1]] = 0
    cells[20:40, 50:70] = 205
    cv2.imwrite(str(tmp_path / "hall.png"), cells)
    file = tmp_path / "hall.yaml"
    file.write_text("image: hall.png\nresolution: 0.1\norigin: [0, 0, 0]\n", encoding="utf-8")
    scenario = trial.scenario.model_copy(update={"plan": load_floor_plan(file)})
    trial.setup = resolve(scenario.read_from(scenario.origin, str(file)))
    trial.play(BagWriter(tmp_path / "mission.bag"), steps=1)
    ((_, grid),) = messages(tmp_path / "mission.bag", "/map")
    expected = np.select([cells == 0, cells == 205], [100, -1], 0)
    np.testing.assert_array_equal(grid.data.reshape(100, 200), np.flipud(expected))


def test_finished_bag_leaves_no_active_file(bag):
    assert os.listdir(bag.parent) == ["mission.bag"]


def test_new_bag_replaces_an_old_one_only_when_it_is_complete(trial, bag):
    before = bag.read_bytes()
    writer = BagWriter(bag)
    writer.begin(trial.setup)
    writer.step(trial.record(1))
    assert bag.read_bytes() == before
    writer.end(trial.result(1))
    assert len(messages(bag, "/tf")) == 1


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "name"), [(BagWriter, "m.bag"), (McapWriter, "m.mcap")])
def test_abandoned_recording_can_be_read_and_one_without_a_step_leaves_nothing(trial, tmp_path, kind, name):
    path = tmp_path / "new" / name
    writer = kind(path)
    writer.begin(trial.setup)
    writer.abandon()
    assert os.listdir(tmp_path) == []
    writer.begin(trial.setup)
    writer.step(trial.record(1))
    writer.abandon()
    assert os.listdir(path.parent) == [name]
    with BagReader([path]) as reader:
        [(_, _, odometry)] = reader.messages({"/robot_0/odom"})
    assert odometry.pose.pose.position.x == pytest.approx(0.05)


def test_unreadable_bag_is_rejected(trial, tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(RecordingError, match=r"file/m\.bag: cannot be written: (Not a directory|File exists)"):
        BagWriter(tmp_path / "file" / "m.bag").begin(trial.setup)
    with pytest.raises(RecordingError, match="is a folder, expected a file name"):
        BagWriter(tmp_path).begin(trial.setup)


@pytest.mark.slow
@needs_rosbag
def test_ros_reads_the_bag(bag):
    info = subprocess.run([ROSBAG, "info", str(bag)], capture_output=True, text=True, check=True).stdout
    assert "/robot_1/base_scan" in info
    assert "robotteamsim/NetworkState" in info


# rosbag's own code has the escape; who compiles it first is told so.
@pytest.mark.filterwarnings("ignore:invalid escape sequence:DeprecationWarning")
def test_rosbag_module_reads_the_bag(bag):
    rosbag = pytest.importorskip("rosbag")
    with rosbag.Bag(str(bag)) as opened:
        goals = [m.goal.x for _, m, _ in opened.read_messages("/robot_0/controller/status")]
    assert goals == [16.0] * 5


_RECORD_FOREVER = textwrap.dedent("""
    import itertools, sys
    from pathlib import Path
    sys.path.insert(0, sys.argv[2])
    from conftest import Trial
    from robotteamsim import scenario
    from robotteamsim.errors import RecordingError
    from robotteamsim.recording import BagWriter

    trial = Trial(scenario.Scenario.model_validate_json(Path(sys.argv[3]).read_text()))
    writer = BagWriter(Path(sys.argv[1]))
    writer.begin(trial.setup)
    try:
        for index in itertools.count(1):
            writer.step(trial.record(index))
            if index % 200 == 0:
                print(index, flush=True)
    except RecordingError as error:
        print(error, file=sys.stderr)
        writer.abandon()
        sys.exit(2)
    """)


def start_recording(trial, path: Path, **popen) -> subprocess.Popen:
    scenario_file = path.with_suffix(".json")
    scenario_file.write_text(trial.scenario.model_dump_json(by_alias=True))
    arguments = [sys.executable, "-c", _RECORD_FOREVER, str(path), str(Path(__file__).parent), str(scenario_file)]
    return subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **popen)


def reindexed_steps(path: Path) -> int:
    """Reindex a broken bag with ROS's tool, read it with rosbags, and return its number of steps."""
    subprocess.run([ROSBAG, "reindex", "-q", str(path)], capture_output=True, check=True)
    info = subprocess.run([ROSBAG, "info", str(path)], capture_output=True, text=True, check=True).stdout
    assert "/robot_0/base_scan" in info
    return len(messages(path, "/robot_1/odom"))


@pytest.mark.slow
@needs_rosbag
def test_bag_of_a_killed_run_is_readable_after_reindexing(trial, tmp_path):
    process = start_recording(trial, tmp_path / "m.bag")
    assert process.stdout.readline() == "200\n"
    process.send_signal(signal.SIGKILL)
    process.communicate(timeout=60)
    assert not (tmp_path / "m.bag").exists()
    assert reindexed_steps(tmp_path / "m.bag.active") >= 100


@pytest.mark.slow
@needs_rosbag
def test_full_disk_ends_a_recording_with_one_line_and_a_bag_to_reindex(trial, tmp_path):
    limit = 1_500_000
    process = start_recording(
        trial, tmp_path / "m.bag", preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
    )
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 2
    active = tmp_path / "m.bag.active"
    wanted = f"{active}: cannot be written: File too large; `rosbag reindex {active}` recovers what was recorded\n"
    assert errors == wanted
    assert reindexed_steps(active) >= 100


def test_topics_of_a_robot_are_silent_while_it_is_not_there(tmp_path):
    schedule = "schedule=[{at_s: 0.3, remove: 1}, {at_s: 0.6, spawn: 1}]"
    path = tmp_path / "fails.bag"
    Simulation(load("garage_sar", [schedule, "mission.time_limit_s=1"])).run([BagWriter(path)])
    with Reader(path) as reader:
        counts = Counter(connection.topic for connection, _, _ in reader.messages())
    mine = {topic: count for topic, count in counts.items() if topic.startswith("/robot_1/")}
    assert set(mine.values()) == {counts["/robot_0/odom"] - 3}
    told = [(time_ns, m.present.tolist(), m.arrivals.tolist()) for time_ns, m in messages(path, "/world/robots")]
    assert told == [
        (100_000_000, [1, 1, 1], [1, 1, 1]),
        (400_000_000, [1, 0, 1], [1, 1, 1]),
        (700_000_000, [1, 1, 1], [1, 2, 1]),
    ]
    frames = [{transform.header.frame_id for transform in m.transforms} for _, m in messages(path, "/tf")]
    assert ["robot_1/odom" in parents for parents in frames[:8]] == [True] * 3 + [False] * 3 + [True] * 2
