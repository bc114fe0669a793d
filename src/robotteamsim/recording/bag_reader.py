"""Bags as they are read without ROS: one recording, whole or in parts, from any world or robot."""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from typing import Any

from rosbags.rosbag1 import Reader
from rosbags.rosbag1.reader import ReaderError
from rosbags.typesys import Stores, TypesysError, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from robotteamsim.errors import RecordingError
from robotteamsim.recording.bag_types import bag_typestore

_MAGIC = b"#ROSBAG V"


class BagReader:
    """Reads messages of ROS 1 bags, compressed or not; a context manager.

    Several paths are the parts of one recording (`rosbag record --split`), in any order.
    """

    def __init__(self, paths: Sequence[Path]) -> None:
        self._paths = list(paths)
        self._stack = contextlib.ExitStack()
        self._readers: list[Reader] = []
        self._typestore = bag_typestore()
        self._types: dict[tuple[str, str], Typestore | None] = {}

    def __enter__(self) -> BagReader:
        """Open the files. Raises: RecordingError: no bag, without an index, or parts that are none of one recording."""
        with contextlib.ExitStack() as stack:
            readers = [stack.enter_context(_opened(path)) for path in self._paths]
            self._readers = sorted(
                (reader for reader in readers if reader.message_count), key=lambda reader: reader.start_time
            )
            for before, after in itertools.pairwise(self._readers):
                if after.start_time < before.end_time - 1:  # rosbags counts to the nanosecond after the last message
                    raise RecordingError(
                        f"{before.path}, {after.path}: overlap in time, so are no parts of a recording"
                    )
            self._stack = stack.pop_all()
        return self

    def __exit__(self, *error: object) -> None:
        """Close the files."""
        self._stack.close()

    @property
    def topics(self) -> dict[str, str]:
        """Types such as "nav_msgs/Odometry" by topic, of all topics with messages, by name."""
        types = {
            connection.topic: connection.msgtype.replace("/msg/", "/")
            for reader in self._readers
            for connection in reader.connections
            if connection.msgcount
        }
        return dict(sorted(types.items()))

    def is_known(self, topic: str) -> bool:
        """Whether the messages of a topic can be read: all types but ROS's own are those that the bag defines."""
        return all(
            self._types_of(connection) is not None
            for reader in self._readers
            for connection in reader.connections
            if connection.topic == topic
        )

    def messages(self, topics: Collection[str]) -> Iterator[tuple[str, int, Any]]:
        """Yield topic, stamp [ns] and message of these topics, in the order of recording.

        The stamp is the header's; that of recording where a message has none. Raises: RecordingError: damaged data.
        """
        for reader in self._readers:
            chosen = [connection for connection in reader.connections if connection.topic in topics]
            if not chosen:
                continue  # rosbags takes no choice for all
            with _damage_told(reader):
                for connection, time_ns, data in reader.messages(chosen):
                    types = self._types_of(connection)
                    assert types is not None, f"{connection.topic} is not known"
                    message: Any = types.deserialize_ros1(data, connection.msgtype)
                    yield connection.topic, _stamp_ns(message) or time_ns, message

    def _types_of(self, connection: Any) -> Typestore | None:
        """Return the types with which the messages of a connection are read; None where that is not possible."""
        key = connection.msgtype, connection.digest
        if key not in self._types:
            self._types[key] = self._typestore if self._is_ours(connection) else _own_types(connection)
        return self._types[key]

    def _is_ours(self, connection: Any) -> bool:
        if connection.msgtype not in self._typestore.types:
            return False
        _, digest = self._typestore.generate_msgdef(connection.msgtype)
        return connection.digest in (digest, "*")


def _own_types(connection: Any) -> Typestore | None:
    """Return ROS's types and those that a bag defines beside them, such as older versions of this package's."""
    types = get_typestore(Stores.ROS1_NOETIC)
    if connection.msgtype in types.types:
        return None  # ROS's own types never change; this is something else under their name.
    try:
        defined = get_types_from_msg(connection.msgdef.data, connection.msgtype)
        types.register({name: kind for name, kind in defined.items() if name not in types.types})
    except TypesysError:
        return None
    return types


@contextlib.contextmanager
def _opened(path: Path) -> Iterator[Reader]:
    """Open one bag. Raises: RecordingError."""
    try:
        with path.open("rb") as file:
            begin = file.read(len(_MAGIC))
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read: {error.strerror or error}; wanted a bag") from None
    if begin != _MAGIC:
        raise RecordingError(f"{path}: {'is no ROS 1 bag' if begin else 'is empty, wanted a bag'}")
    reader = Reader(path)
    with _damage_told(reader):
        reader.open()
    try:
        yield reader
    finally:
        reader.close()


@contextlib.contextmanager
def _damage_told(reader: Reader) -> Iterator[None]:
    """Turn what rosbags and decompressors raise on damaged files into one line that names the cure."""
    try:
        yield
    except (GeneratorExit, MemoryError, RecordingError):
        raise
    except Exception as error:  # Of bytes at random: AssertionError, IndexError, KeyError, struct.error, and so on.
        path = str(reader.path)
        why = "is damaged"
        if isinstance(error, ReaderError):
            if "not indexed" in str(error):
                why = "has no index, because its recording was broken off"
            elif "not supported" in str(error):
                raise RecordingError(f"{path}: {str(error).rstrip('.')}") from error
        raise RecordingError(f"{path}: {why}; `rosbag reindex {path}` saves what can be read") from error


def _stamp_ns(message: Any) -> int:
    """Return the stamp of a message's header [ns]; 0 where it has none."""
    header = getattr(message, "header", None)
    return header.stamp.sec * 10**9 + header.stamp.nanosec if header else 0
