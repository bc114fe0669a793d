"""Reads bags without ROS: one recording in one or several files, from any simulator or robot."""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from typing import Any

from rosbags.rosbag1 import Reader
from rosbags.rosbag1.reader import ReaderError
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from robotteamsim.errors import RecordingError
from robotteamsim.recording.bag_types import bag_typestore

_MAGIC = b"#ROSBAG V"


class BagReader:
    """Reads the messages of ROS 1 bags, compressed or not; a context manager.

    Several paths are the parts of one recording (`rosbag record --split`), in any order.
    """

    def __init__(self, paths: Sequence[Path]) -> None:
        self._paths = list(paths)
        self._stack = contextlib.ExitStack()
        self._readers: list[Reader] = []
        self._typestore = bag_typestore()
        self._types: dict[tuple[str, str], Typestore | None] = {}

    def __enter__(self) -> BagReader:
        """Open the files. Raises: RecordingError: not a bag, no index, or files that are not parts of one recording."""
        with contextlib.ExitStack() as stack:
            readers = [stack.enter_context(_open(path)) for path in self._paths]
            self._readers = sorted(
                (reader for reader in readers if reader.message_count), key=lambda reader: reader.start_time
            )
            for before, after in itertools.pairwise(self._readers):
                if after.start_time < before.end_time - 1:  # rosbags counts to the nanosecond after the last message
                    raise RecordingError(
                        f"{before.path}, {after.path}: overlap in time, so they are not parts of one recording"
                    )
            self._stack = stack.pop_all()
        return self

    def __exit__(self, *error: object) -> None:
        """Close the files."""
        self._stack.close()

    @property
    def topics(self) -> dict[str, str]:
        """Type of each topic that has messages, such as "nav_msgs/Odometry", sorted by topic."""
        types = {
            connection.topic: connection.msgtype.replace("/msg/", "/")
            for reader in self._readers
            for connection in reader.connections
            if connection.msgcount
        }
        return dict(sorted(types.items()))

    def is_known(self, topic: str) -> bool:
        """Whether the messages of a topic can be read; custom types are read as the bag defines them."""
        return all(
            self._types_of(connection) is not None
            for reader in self._readers
            for connection in reader.connections
            if connection.topic == topic
        )

    def messages(self, topics: Collection[str]) -> Iterator[tuple[str, int, Any]]:
        """Yield topic, stamp [ns] and message of these topics, in the order of recording.

        The stamp is that of the header, or the time of recording for a message without one.
        Raises: RecordingError: the data are damaged.
        """
        for reader in self._readers:
            chosen = [connection for connection in reader.connections if connection.topic in topics]
            if not chosen:
                continue  # rosbags reads all connections if none is chosen
            with _damage_reported(reader):
                for connection, time_ns, data in reader.messages(chosen):
                    types = self._types_of(connection)
                    assert types is not None, f"{connection.topic} is not known"
                    message: Any = types.deserialize_ros1(data, connection.msgtype)
                    yield connection.topic, _stamp_ns(message) or time_ns, message

    def _types_of(self, connection: Any) -> Typestore | None:
        """Return the types for the messages of a connection, or None if they cannot be read."""
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
    """Return ROS's types and those that the bag defines itself, such as older versions of this package's types."""
    types = get_typestore(Stores.ROS1_NOETIC)
    if connection.msgtype in types.types:
        return None  # ROS's own types never change, so this is a different type of the same name.
    try:
        defined = get_types_from_msg(connection.msgdef.data, connection.msgtype)
        types.register({name: kind for name, kind in defined.items() if name not in types.types})
    except Exception:  # rosbags turns definitions into Python code: any error of that, such as SyntaxError
        return None
    return types


@contextlib.contextmanager
def _open(path: Path) -> Iterator[Reader]:
    """Open one bag. Raises: RecordingError."""
    try:
        with path.open("rb") as file:
            begin = file.read(len(_MAGIC))
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read: {error.strerror or error}; expected a bag") from None
    if begin != _MAGIC:
        raise RecordingError(f"{path}: {'is not a ROS 1 bag' if begin else 'is empty, expected a bag'}")
    reader = Reader(path)
    with _damage_reported(reader):
        reader.open()
    try:
        yield reader
    finally:
        reader.close()


@contextlib.contextmanager
def _damage_reported(reader: Reader) -> Iterator[None]:
    """Convert the exceptions of rosbags and decompressors on damaged files to one line that names the remedy."""
    try:
        yield
    except (GeneratorExit, MemoryError, RecordingError):
        raise
    except Exception as error:  # Damaged bytes cause AssertionError, IndexError, KeyError, struct.error and others.
        path = str(reader.path)
        why = "is damaged"
        if isinstance(error, ReaderError):
            if "not indexed" in str(error):
                why = "has no index, because its recording was interrupted"
            elif "not supported" in str(error):
                raise RecordingError(f"{path}: {str(error).rstrip('.')}") from error
        raise RecordingError(f"{path}: {why}; `rosbag reindex {path}` recovers what can be read") from error


def _stamp_ns(message: Any) -> int:
    """Return the stamp of a message's header [ns], or 0 if it has none."""
    header = getattr(message, "header", None)
    return header.stamp.sec * 10**9 + header.stamp.nanosec if header else 0
