"""MCAP files: other libraries read what a trial had, and files that are damaged or foreign give one line."""

from __future__ import annotations

import json
import re
import struct
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap.writer import Writer
from mcap_ros2.decoder import DecoderFactory

from robotteamsim.cli import main
from robotteamsim.errors import RecordingError
from robotteamsim.recording import BagWriter, McapWriter
from robotteamsim.recording.bag_reader import BagReader


@pytest.fixture
def mcap(trial, tmp_path) -> Path:
    path = tmp_path / "mission.mcap"
    trial.play(McapWriter(path), steps=5)
    return path


def decoded(path: Path, topic: str) -> list:
    """Read messages with the libraries of the format's authors, which know no type of this package."""
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        found = reader.iter_decoded_messages(topics=[topic])
        return [(message.log_time, value) for _, _, message, value in found]


def refusal(path: Path) -> str:
    with pytest.raises(RecordingError) as refused, BagReader([path]) as reader:
        list(reader.messages(reader.topics))
    assert "\n" not in str(refused.value)
    return str(refused.value)


def test_layout_of_foxglove_shows_what_a_recording_contains(tmp_path):
    """The form of the file is that of Lichtblick 1.28 (LayoutData), and of Foxglove Studio 1.48, which drew it."""
    path = tmp_path / "mission.mcap"
    assert main(["run", "garage_sar", "--set", "mission.time_limit_s=2", "--mcap", str(path)]) == 0
    layout = json.loads(Path("templates/layout/my_layout.json").read_text())
    panels = layout["configById"]
    assert sorted(panels) == sorted(re.findall(r'"(\w+!\w+)"', json.dumps(layout["layout"])))
    absent = re.compile(r"/?robot_[3-7]/")  # there is place for eight robots
    values = [path["value"] for panel in panels.values() for path in panel.get("paths", ())]
    for topic, _, field in (value.partition(".") for value in values if not absent.match(value)):
        assert all(np.isscalar(getattr(message, field)) for _, message in decoded(path, topic)), topic
    scene, rviz = panels["3D!mission"], Path("rviz/robotteamsim.rviz").read_text()
    drawn = [topic for topic in scene["topics"] if not absent.match(topic)]
    assert [topic for topic in drawn if not decoded(path, topic) and f"Marker Topic: {topic}," not in rviz] == []
    transforms = [transform for _, message in decoded(path, "/tf") for transform in message.transforms]
    parents = {transform.child_frame_id: transform.header.frame_id for transform in transforms}
    assert {parents[f"robot_{i}/odom"] for i in range(3)} == {"map"}  # where robots stand on the map
    hidden = {frame.removeprefix("frame:") for frame in scene["transforms"]}
    assert {frame for frame in hidden if not absent.match(frame)} == {"map", *parents} - {
        f"robot_{i}/base_laser_link"
        for i in range(3)  # above the map, whose cells hide what is at its height
    }


def test_stock_library_reads_poses_scans_and_our_own_messages(trial, mcap):
    truths, scans = decoded(mcap, "/robot_1/base_pose_ground_truth"), decoded(mcap, "/robot_0/base_scan")
    for record, (time_ns, truth), (_, scan) in zip(trial.records(5), truths, scans, strict=True):
        own, pose = record.readings[1].ground_truth, truth.pose.pose
        assert time_ns == record.sim_time_ns == truth.header.stamp.sec * 10**9 + truth.header.stamp.nanosec
        assert (pose.position.x, pose.position.y, pose.orientation.z) == (own.x_m, own.y_m, own.qz)
        np.testing.assert_array_equal(np.float32(scan.ranges), record.readings[0].ranges_m)
    [(_, event)] = decoded(mcap, "/mission/events")
    assert event.detail == "robot 1 saves ann (1 of 2)"
    assert [victim.state for victim in decoded(mcap, "/mission/victims")[-1][1].victims] == ["saved", "waiting"]
    assert list(decoded(mcap, "/network/state")[0][1].rssi_dbm) == trial.record(1).network.rssi_dbm.ravel().tolist()


@pytest.mark.slow
def test_topics_types_and_numbers_of_messages_are_those_of_a_bag(trial, mcap, tmp_path):
    trial.play(BagWriter(tmp_path / "mission.bag"), steps=5)
    counts = []
    for path in (mcap, tmp_path / "mission.bag"):
        with BagReader([path]) as reader:
            counts.append((reader.topics, Counter(topic for topic, _, _ in reader.messages(reader.topics))))
    assert counts[0] == counts[1]


def test_nothing_but_the_file_remains(mcap):
    assert list(mcap.parent.iterdir()) == [mcap]


def test_file_of_another_name_is_rejected(mcap):
    path = mcap.rename(mcap.with_suffix(".bag"))
    assert refusal(path) == f"{path}: is an MCAP file; expected a name that ends in .mcap"


def test_message_of_a_bare_stamp_is_read(tmp_path):
    path = tmp_path / "stamps.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(profile="ros2", library="another")
        schema = writer.register_schema("builtin_interfaces/msg/Time", "ros2msg", b"int32 sec\nuint32 nanosec")
        channel = writer.register_channel("/stamp", "cdr", schema, {"offered_qos_profiles": ""})
        writer.add_message(channel, 5, struct.pack("<IiI", 0x100, 3, 7), 5)
        writer.finish()
    with BagReader([path]) as reader:
        [(topic, time_ns, stamp)] = reader.messages(reader.topics)
    assert (topic, time_ns, stamp.sec, stamp.nanosec) == ("/stamp", 5, 3, 7)
