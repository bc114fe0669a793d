from __future__ import annotations

import shutil
import struct
from pathlib import Path

import pytest
from rosbags.rosbag1 import Reader, Writer

from robotteamsim.errors import RecordingError
from robotteamsim.recording import BagWriter, McapWriter
from robotteamsim.recording.bag_reader import BagReader
from robotteamsim.recording.bag_types import bag_typestore


@pytest.fixture
def bag(trial, tmp_path) -> Path:
    path = tmp_path / "mission.bag"
    trial.play(BagWriter(path), steps=5)
    return path


@pytest.fixture(params=["bag", "mcap"])
def recording(request, trial, tmp_path) -> Path:
    """A recording of each format."""
    path = tmp_path / f"mission.{request.param}"
    trial.play({"bag": BagWriter, "mcap": McapWriter}[request.param](path), steps=5)
    return path


def rewritten(bag: Path, name: str, first_ns: int = 0, last_ns: int = 2**62, compression: str | None = None) -> Path:
    """Copy the messages of a time into another bag."""
    path, typestore, connections = bag.with_name(name), bag_typestore(), {}
    writer = Writer(path)
    if compression:
        writer.set_compression(Writer.CompressionFormat[compression])
    with writer, Reader(bag) as reader:
        for connection, time_ns, data in reader.messages():
            if first_ns <= time_ns <= last_ns:
                if connection.topic not in connections:
                    known = writer.add_connection(connection.topic, connection.msgtype, typestore=typestore)
                    connections[connection.topic] = known
                writer.write(connections[connection.topic], time_ns, data)
    return path


def stamps(*paths: Path, topic: str = "/robot_0/odom") -> list[int]:
    with BagReader(paths) as reader:
        return [stamp_ns for _, stamp_ns, _ in reader.messages({topic})]


def refusal(*paths: Path) -> str:
    with pytest.raises(RecordingError) as refused, BagReader(paths) as reader:
        list(reader.messages(reader.topics))
    assert "\n" not in str(refused.value)
    return str(refused.value)


def test_reader_lists_topics_and_types(bag):
    with BagReader([bag]) as reader:
        assert reader.topics["/robot_1/odom"] == "nav_msgs/Odometry"
        assert list(reader.topics) == sorted(reader.topics)


def test_stamps_are_those_of_headers_and_else_of_recording(bag):
    assert stamps(bag) == [100_000_000 * step for step in range(1, 6)]
    assert stamps(bag, topic="/robot_0/cmd_vel") == [100_000_000 * step for step in range(1, 6)]


@pytest.mark.parametrize("compression", ["BZ2", "LZ4"])
def test_compressed_bags_hold_the_same(bag, compression):
    assert stamps(rewritten(bag, "packed.bag", compression=compression)) == stamps(bag)


def test_parts_of_a_recording_are_one_in_any_order(bag):
    first, second = rewritten(bag, "a.bag", last_ns=299_999_999), rewritten(bag, "b.bag", first_ns=300_000_000)
    assert stamps(second, first) == stamps(bag)


def test_overlapping_bags_are_rejected_as_parts(bag):
    first, second = rewritten(bag, "a.bag", last_ns=300_000_000), rewritten(bag, "b.bag", first_ns=200_000_000)
    assert refusal(first, second) == f"{first}, {second}: overlap in time, so they are not parts of one recording"


def test_types_that_are_not_ours_are_read_as_the_bag_defines_them(tmp_path):
    path = tmp_path / "old.bag"
    with Writer(path) as writer:
        kind, text = "robotteamsim/msg/NetworkState", "uint32 num_robots\nstring only_then\n"
        ours = writer.add_connection("/network/state", kind, msgdef=text, md5sum="0" * 32)
        writer.write(ours, 7, b"\3\0\0\0\2\0\0\0ok")
    with BagReader([path]) as reader:
        assert reader.is_known("/network/state")
        ((_, stamp_ns, message),) = reader.messages({"/network/state"})
    assert (stamp_ns, message.num_robots, message.only_then) == (7, 3, "ok")


@pytest.mark.parametrize(("kind", "text"), [("nav_msgs/msg/Odometry", "bool x\n"), ("a/msg/B", "no/such C\n{")])
def test_types_that_contradict_ros_or_cannot_be_read_are_not_known(tmp_path, kind, text):
    path = tmp_path / "odd.bag"
    with Writer(path) as writer:
        writer.write(writer.add_connection("/odd", kind, msgdef=text, md5sum="0" * 32), 7, b"\0")
    with BagReader([path]) as reader:
        assert not reader.is_known("/odd")


def test_missing_file_is_rejected(tmp_path):
    path = tmp_path / "no.bag"
    assert refusal(path) == f"{path}: cannot be read: No such file or directory; expected a bag"


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (b"", "is empty, expected a bag"),
        (b"PNG\r\n", "is none of a ROS 1 bag, an MCAP file, a file of SQLite"),
        (b"SQLite format 3\0", "is a file of SQLite; expected a name that ends in .db3"),
    ],
)
def test_file_that_is_not_a_bag_is_rejected(tmp_path, content, why):
    path = tmp_path / "picture.bag"
    path.write_bytes(content)
    assert refusal(path) == f"{path}: {why}"


def test_bag_of_an_old_format_is_rejected(tmp_path):
    path = tmp_path / "old.bag"
    path.write_bytes(b"#ROSBAG V1.2\n" + bytes(100))
    why = "cannot be read: Bag version 102 is not supported"
    assert refusal(path) == f"{path}: {why}; `rosbag reindex {path}` recovers what can be read"


@pytest.mark.parametrize("share", [0.001, 0.2, 0.6, 0.99])
def test_truncated_file_is_rejected_with_its_remedy(recording, share):
    content = recording.read_bytes()
    recording.write_bytes(content[: max(round(share * len(content)), 9)])
    line = refusal(recording)
    assert line.startswith(
        (f"{recording}: cannot be read: ", f"{recording}: is damaged: ", f"{recording}: is damaged; ")
    )
    remedies = {
        ".bag": f"`rosbag reindex {recording}` recovers what can be read",
        ".mcap": f"`mcap recover {recording} -o recovered.mcap` saves what can be read",
    }
    assert line.endswith(f"; {remedies[recording.suffix]}")


def test_length_beyond_the_end_of_the_file_is_named_and_not_read(recording):
    """The memory for it would be allocated before the file turns out to be shorter."""
    content, place, field = recording.read_bytes(), 13, "<I"  # the length of the first header of a bag
    if recording.suffix == ".mcap":
        place, field = 9, "<Q"  # the length of the first record
    claimed = 2**31 - 1
    recording.write_bytes(content[:place] + struct.pack(field, claimed) + content[place + struct.calcsize(field) :])
    place += struct.calcsize(field)
    why = f"is damaged: {claimed} bytes are claimed at byte {place}, but {len(content) - place} are left"
    assert refusal(recording).startswith(f"{recording}: {why}; ")


def test_bag_of_a_recording_that_was_interrupted_is_rejected_with_its_remedy(trial, tmp_path):
    path, writer = tmp_path / "mission.bag", BagWriter(tmp_path / "mission.bag")
    writer.begin(trial.setup)
    writer.step(trial.record(1))
    broken = tmp_path / "broken.bag"
    shutil.copy(path.with_name("mission.bag.active"), broken)
    writer.abandon()
    why = "cannot be read: Bag is not indexed, reindex before reading"
    assert refusal(broken) == f"{broken}: {why}; `rosbag reindex {broken}` recovers what can be read"


def test_message_whose_connection_is_not_that_of_the_index_is_damage(bag):
    with Reader(bag) as reader:
        first, other = (c for c in reader.connections if c.topic in ("/robot_0/odom", "/robot_1/odom"))
    content = bag.read_bytes()
    number, time = b"conn=" + struct.pack("<I", first.id), b"\x0d\0\0\0time="
    assert number + time in content
    bag.write_bytes(content.replace(number + time, b"conn=" + struct.pack("<I", other.id) + time, 1))
    with BagReader([bag]) as damaged, pytest.raises(RecordingError, match=r"mission.bag: is damaged; `rosbag reindex"):
        list(damaged.messages([first.topic]))


@pytest.mark.slow
def test_bytes_changed_anywhere_give_one_line_or_can_be_read(recording):
    content, refused = recording.read_bytes(), []
    for place in range(13, len(content) - 8, len(content) // 150):
        recording.write_bytes(content[:place] + b"\xff" * 8 + content[place + 8 :])
        try:
            with BagReader([recording]) as reader:
                list(reader.messages([topic for topic in reader.topics if reader.is_known(topic)]))
        except RecordingError as error:
            refused.append(str(error))
    assert refused
    assert all(line.startswith(f"{recording}: ") and "\n" not in line for line in refused)


@pytest.mark.parametrize("recording", ["bag"], indirect=True)
def test_damaged_index_is_named_without_values_of_python(recording, tmp_path):
    path = tmp_path / "odd.bag"
    before, key, after = recording.read_bytes().rpartition(b"message_definition=")
    path.write_bytes(before + key.replace(b"message", b"Message") + after)
    why = "cannot be read: Bag index looks damaged"
    assert refusal(path) == f"{path}: {why}; `rosbag reindex {path}` recovers what can be read"
