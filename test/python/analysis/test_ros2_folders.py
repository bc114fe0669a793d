"""Bags of ROS 2: folders of `ros2 bag record` and their files, in each storage and compression, are one recording."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import pytest
import yaml
from mcap.writer import Writer as McapFile
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

from robotteamsim.errors import RecordingError
from robotteamsim.recording.bag_types import ROS2, bag_typestore, message_type
from robotteamsim.recording.replay.reading import read_run
from robotteamsim.view.from_bag import recording_of

ODOMETRY = "nav_msgs/Odometry"
SECOND_NS = 10**9


def drive(odometry: Callable[..., Any], steps: Iterable[int] = range(101)) -> Iterable[tuple[str, int, Any]]:
    """A robot that drives 10 m in 10 s; topic, time and message of some of its steps of 0.1 s."""
    for step in steps:
        time_ns = 1000 * SECOND_NS + step * SECOND_NS // 10
        yield "/odom", time_ns, odometry(time_ns, 0.1 * step, 0.0, frame="odom")


def write(
    folder: Path,
    messages: Iterable[tuple[str, int, Any]],
    plugin: StoragePlugin = StoragePlugin.MCAP,
    mode: CompressionMode = CompressionMode.NONE,
) -> Path:
    """Write a folder as `ros2 bag record` does, by the library of another author."""
    bag, connections = Writer(folder, version=9, storage_plugin=plugin), {}
    bag.set_compression(mode, CompressionFormat.ZSTD)
    with bag:
        for topic, time_ns, message in messages:
            if topic not in connections:
                connections[topic] = bag.add_connection(topic, "nav_msgs/msg/Odometry", typestore=bag_typestore(ROS2))
            bag.write(connections[topic], time_ns, message_type(ODOMETRY, ROS2).encode(message))
    return folder


def driven(path: Path) -> tuple[str, float, float]:
    """Name of the run, and how far [m] and how long [s] its only robot drove."""
    run = read_run([path])
    (robot,) = run.robots
    return run.name, round(float(robot.track.driven_m[-1]), 9), (run.end_ns - run.start_ns) / SECOND_NS


def refusal(path: Path) -> str:
    with pytest.raises(RecordingError) as refused:
        read_run([path])
    assert "\n" not in str(refused.value)
    return str(refused.value)


@pytest.mark.parametrize(
    ("plugin", "mode"),
    [
        (StoragePlugin.MCAP, CompressionMode.NONE),
        (StoragePlugin.MCAP, CompressionMode.FILE),
        (StoragePlugin.MCAP, CompressionMode.MESSAGE),
        (StoragePlugin.MCAP, CompressionMode.STORAGE),
        (StoragePlugin.SQLITE3, CompressionMode.NONE),
        (StoragePlugin.SQLITE3, CompressionMode.FILE),
        (StoragePlugin.SQLITE3, CompressionMode.MESSAGE),
    ],
)
def test_folder_and_its_file_are_read_in_each_storage_and_compression(odometry, tmp_path, plugin, mode):
    folder = write(tmp_path / "run", drive(odometry), plugin, mode).rename(tmp_path / "run 1.#2?")
    assert driven(folder) == ("run 1.#2?", 10.0, 10.0)
    (file,) = (path for path in folder.iterdir() if path.suffix != ".yaml")
    alone = "cannot be read alone; expected the folder that contains it, with metadata.yaml"
    assert refusal(folder / "metadata.yaml") == f"{folder / 'metadata.yaml'}: {alone}"
    if mode is CompressionMode.FILE:
        assert refusal(file) == f"{file}: {alone}"
    else:
        assert driven(file) == (file.stem, 10.0, 10.0)


def of_two_files(odometry: Callable[..., Any], tmp_path: Path) -> Path:
    first, second = (
        write(tmp_path / name, drive(odometry, steps)) for name, steps in (("a", range(50)), ("b", range(50, 101)))
    )
    metadata = yaml.safe_load((first / "metadata.yaml").read_text())
    information = metadata["rosbag2_bagfile_information"]
    (second / "b.mcap").rename(first / "b.mcap")
    information["relative_file_paths"].append("b.mcap")
    information["message_count"] = information["topics_with_message_count"][0]["message_count"] = 101
    information["duration"]["nanoseconds"] = 10 * SECOND_NS
    (first / "metadata.yaml").write_text(yaml.safe_dump(metadata))
    return first


def test_files_of_a_folder_are_one_recording(odometry, tmp_path):
    assert driven(of_two_files(odometry, tmp_path)) == ("a", 10.0, 10.0)


@pytest.mark.parametrize("file", ["a.mcap", "b.mcap"])
@pytest.mark.parametrize("share", [0.2, 0.6, 0.99])
def test_truncated_file_of_a_folder_is_named(odometry, tmp_path, file, share):
    damaged = of_two_files(odometry, tmp_path) / file
    content = damaged.read_bytes()
    damaged.write_bytes(content[: round(share * len(content))])
    line = refusal(damaged.parent)
    assert line.startswith(f"{damaged}: ")
    assert line.endswith(f"; `mcap recover {damaged} -o recovered.mcap` saves what can be read")


def test_folder_whose_metadata_is_damaged_is_named_itself(odometry, tmp_path):
    folder = of_two_files(odometry, tmp_path)
    (folder / "metadata.yaml").write_text("rosbag2_bagfile_information: 1\n")
    line = refusal(folder)
    assert line.startswith(f"{folder}: ")
    assert line.endswith(f"`ros2 bag reindex {folder}` writes metadata.yaml again, from files that are not damaged")


def test_file_without_definitions_is_read(odometry, tmp_path):
    """As Humble writes it: schema 3 [rosbag2_storage_default_plugins 0.15, sqlite_storage.cpp]."""
    path = tmp_path / "humble_0.db3"
    with sqlite3.connect(path) as base:
        base.executescript("""
            CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
            INSERT INTO schema VALUES (3, 'humble');
            CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
                serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
            CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
                data BLOB NOT NULL);
            CREATE INDEX timestamp_idx ON messages (timestamp ASC);
            INSERT INTO topics VALUES (1, '/odom', 'nav_msgs/msg/Odometry', 'cdr', ''), (2, '/x', 'x/msg/X', 'cdr', '');
            INSERT INTO messages (topic_id, timestamp, data) VALUES (2, 1000000000000, x'00010000');
            """)
        for _, time_ns, message in drive(odometry):
            data = message_type(ODOMETRY, ROS2).encode(message)
            base.execute("INSERT INTO messages (topic_id, timestamp, data) VALUES (1, ?, ?)", (time_ns, data))
    base.close()
    assert driven(path) == ("humble_0", 10.0, 10.0)


def test_player_shows_a_folder(odometry, tmp_path):
    path = write(tmp_path / "shown", drive(odometry))
    recording = recording_of(read_run([path]))
    assert recording.title == "shown"
    x_m, _, _ = recording.frames[-1].poses[0]
    assert x_m == pytest.approx(10.0)


def test_folder_without_metadata_is_rejected_with_its_remedy(odometry, tmp_path):
    folder = write(tmp_path / "killed", drive(odometry))
    (folder / "metadata.yaml").unlink()
    assert refusal(folder) == (
        f"{folder}: is a folder without metadata.yaml; expected a bag (`ros2 bag reindex {folder}` writes the file, or "
        "give the bags in the folder)"
    )


def test_folder_of_a_run_is_named_as_such(tmp_path):
    (tmp_path / "mission.json").write_text("{}")
    assert refusal(tmp_path) == f"{tmp_path}: is a folder of `run --out`; expected a bag, such as one of `run --bag`"


def test_folder_that_lacks_a_file_or_messages_is_rejected(odometry, tmp_path):
    folder = write(tmp_path / "part", drive(odometry))
    remedy = f"`ros2 bag reindex {folder}` writes metadata.yaml again, from files that are not damaged"
    text = (folder / "metadata.yaml").read_text()
    (folder / "metadata.yaml").write_text(text.replace("name: /odom", "name: /robot1/odom"))
    why = "is damaged: the messages of /robot1/odom are listed, but not there"
    assert refusal(folder) == f"{folder}: {why}; {remedy}"
    (folder / "part.mcap").unlink()
    assert refusal(folder) == f"{folder}: cannot be read: Some database files are missing; {remedy}"


@pytest.mark.parametrize("place", [0, 30, 5_000])
def test_damaged_base_is_one_line_with_its_remedy(odometry, tmp_path, place):
    folder = write(tmp_path / "odd", drive(odometry), StoragePlugin.SQLITE3)
    file = folder / "odd.db3"
    content = file.read_bytes()
    file.write_bytes(content[: place or len(content) // 2] + bytes(64 if place else 0) + content[place + 64 :][:place])
    assert refusal(file).startswith(f"{file}: ")
    assert refusal(file).endswith(f"; `sqlite3 {file} .recover` prints what can be read")


@pytest.mark.parametrize(
    ("profile", "schema", "why"),
    [
        ("ros1", "ros1msg", "is an MCAP file with messages of ROS 1; expected those of ROS 2, or a ROS 1 bag"),
        ("", "jsonschema", "is an MCAP file of another kind, such as JSON: its profile is '', not 'ros2'"),
        (
            "ros2",
            "jsonschema",
            "is damaged, or has messages that are not of ROS 2; `mcap recover {path} -o recovered.mcap` saves what can "
            "be read",
        ),
    ],
)
def test_mcap_file_of_other_messages_is_named_as_what_it_is(tmp_path, profile, schema, why):
    path = tmp_path / "other.mcap"
    with path.open("wb") as file:
        writer = McapFile(file)
        writer.start(profile=profile, library="another")
        channel = writer.register_channel("/odom", "json", writer.register_schema("Odometry", schema, b"{}"))
        writer.add_message(channel, 5, b"{}", 5)
        writer.finish()
    assert refusal(path) == f"{path}: {why.format(path=path)}"
