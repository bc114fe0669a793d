"""Reads bags without ROS: one recording in one or several files, from any simulator or robot."""

from __future__ import annotations

import contextlib
import functools
import itertools
from collections.abc import Callable, Collection, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from rosbags import rosbag1, rosbag2
from rosbags.interfaces import MessageDefinition, MessageDefinitionFormat
from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from robotteamsim.errors import RecordingError
from robotteamsim.recording.bag_file import BagFile, DamagedFileError
from robotteamsim.recording.bag_types import bag_typestore
from robotteamsim.recording.mcap_writer import SUFFIX
from robotteamsim.user_files import open_regular

Reader = rosbag1.Reader | rosbag2.Reader
Decode = Callable[[bytes, str], Any]
"""Returns the message of data and the name of its type."""


class _Format(NamedTuple):
    """What differs between ROS 1 bags and MCAP files.

    magic:   the first bytes of each file.
    decoder: returns a function that reads the messages of a connection; None if its type cannot be read.
    remedy:  the program that makes a damaged file readable.
    """

    magic: bytes
    reader: Callable[[BagFile], Reader]
    decoder: Callable[[Any], Decode | None]
    remedy: str


class _Part(NamedTuple):
    """One open file."""

    path: Path
    reader: Reader
    format: _Format


class BagReader:
    """Reads the messages of ROS 1 bags and of MCAP files of ROS 2, compressed or not; a context manager.

    Several paths are the parts of one recording (`rosbag record --split`), in any order.
    """

    def __init__(self, paths: Sequence[Path]) -> None:
        self._paths = list(paths)
        self._stack = contextlib.ExitStack()
        self._parts: list[_Part] = []
        self._decoders: dict[Any, Decode | None] = {}

    def __enter__(self) -> BagReader:
        """Open the files. Raises: RecordingError: not a bag, no index, or files that are not parts of one recording."""
        with contextlib.ExitStack() as stack:
            parts = [stack.enter_context(_open(path)) for path in self._paths]
            self._parts = sorted(
                (part for part in parts if part.reader.message_count), key=lambda part: part.reader.start_time
            )
            for before, after in itertools.pairwise(self._parts):
                if (
                    after.reader.start_time < before.reader.end_time - 1
                ):  # rosbags counts to the nanosecond after the last message
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
            for part in self._parts
            for connection in part.reader.connections
            if connection.msgcount
        }
        return dict(sorted(types.items()))

    def is_known(self, topic: str) -> bool:
        """Whether the messages of a topic can be read; custom types are read as the bag defines them."""
        return all(
            self._decoder(part, connection) is not None
            for part in self._parts
            for connection in part.reader.connections
            if connection.topic == topic
        )

    def messages(self, topics: Collection[str]) -> Iterator[tuple[str, int, Any]]:
        """Yield topic, stamp [ns] and message of these topics, in the order of recording.

        The stamp is that of the header, or the time of recording for a message without one.
        Raises: RecordingError: the data are damaged.
        """
        for part in self._parts:
            chosen: Any = [connection for connection in part.reader.connections if connection.topic in topics]
            if not chosen:
                continue  # rosbags reads all connections if none is chosen
            with _damage_reported(part):
                for connection, time_ns, data in part.reader.messages(chosen):
                    if connection.topic not in topics:
                        raise ValueError("the index names another connection")
                    decode = self._decoder(part, connection)
                    assert decode is not None, f"{connection.topic} is not known"
                    message: Any = decode(data, connection.msgtype)
                    yield connection.topic, _stamp_ns(message) or time_ns, message

    def _decoder(self, part: _Part, connection: Any) -> Decode | None:
        """Return the function that reads the messages of a connection, or None if they cannot be read."""
        key = part.format.magic, connection.msgtype, connection.digest, connection.msgdef
        if key not in self._decoders:
            self._decoders[key] = part.format.decoder(connection)
        return self._decoders[key]


@contextlib.contextmanager
def _open(path: Path) -> Iterator[_Part]:
    """Open one bag. Raises: RecordingError."""
    try:
        with open_regular(path) as file:
            begin = file.read(max(len(one.magic) for one in _FORMATS))
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read: {error.strerror or error}; expected a bag") from None
    known = next((one for one in _FORMATS if begin.startswith(one.magic)), None)
    if known is None:
        why = "is neither a ROS 1 bag nor an MCAP file" if begin else "is empty, expected a bag"
        raise RecordingError(f"{path}: {why}")
    part = _Part(path, known.reader(BagFile(path)), known)
    with _damage_reported(part):
        part.reader.open()
    try:
        yield part
    finally:
        part.reader.close()


@contextlib.contextmanager
def _damage_reported(part: _Part) -> Iterator[None]:
    """Convert the exceptions of rosbags and decompressors on damaged files to one line that names the remedy."""
    try:
        yield
    except (GeneratorExit, RecordingError):
        raise
    except Exception as error:  # Damaged bytes cause AssertionError, IndexError, KeyError, struct.error and others.
        why = "is damaged"
        if isinstance(error, DamagedFileError):
            why = f"is damaged: {error}"
        elif isinstance(error, MemoryError):  # a compressed part claims more than fits, or the bag is honest and large
            why = "is damaged, or has more data than the memory can hold"
        elif isinstance(error, rosbag1.ReaderError | rosbag2.ReaderError):
            # After a colon come Python's values and texts of other libraries.
            why = f"cannot be read: {' '.join(str(error).partition(':')[0].split()).rstrip('.')}"
        raise RecordingError(f"{part.path}: {why}; {part.format.remedy.format(path=part.path)}") from error


def _stamp_ns(message: Any) -> int:
    """Return the stamp of a message's header [ns], or 0 if it has none."""
    header = getattr(message, "header", None)
    return header.stamp.sec * 10**9 + header.stamp.nanosec if header else 0


def _ros1_decoder(connection: Any) -> Decode | None:
    """Types that are not ours are read as the bag defines them."""
    ours = bag_typestore()
    if connection.msgtype in ours.types and connection.digest in (ours.generate_msgdef(connection.msgtype)[1], "*"):
        return ours.deserialize_ros1
    if connection.msgtype in get_typestore(Stores.ROS1_NOETIC).types:
        return None  # ROS's own types never change, so this is a different type of the same name.
    types = _own_types(Stores.ROS1_NOETIC, connection.msgtype, connection.msgdef)
    return None if types is None else types.deserialize_ros1


def _mcap_reader(file: BagFile) -> Reader:
    if file.suffix != SUFFIX:  # rosbags would not know the format.
        raise RecordingError(f"{file}: is an MCAP file; expected a name that ends in {SUFFIX}")
    return rosbag2.Reader(file)


def _cdr_decoder(connection: Any) -> Decode | None:
    """All types are read as the file defines them; messages of another encoding than CDR are not."""
    if connection.ext.serialization_format != "cdr":
        return None
    types = _own_types(Stores.EMPTY, connection.msgtype, connection.msgdef)
    return None if types is None else types.deserialize_cdr


# Cached, because rosbags compiles code for each type, which takes longer than reading a short recording.
@functools.lru_cache(maxsize=1024)
def _own_types(ros: Stores, message_type: str, definition: MessageDefinition) -> Typestore | None:
    """Return the types of a version of ROS and those that a connection defines, such as older ones of this package.

    None: the definition cannot be read.
    """
    types = get_typestore(ros)
    try:
        if definition.format is MessageDefinitionFormat.IDL:
            defined = get_types_from_idl(definition.data)
        else:
            defined = get_types_from_msg(definition.data, message_type)
        types.register({name: kind for name, kind in defined.items() if name not in types.types})
    except Exception:  # rosbags turns definitions into Python code: any error of that, such as SyntaxError
        return None
    return types if message_type in types.types else None


_FORMATS = (
    _Format(b"#ROSBAG V", rosbag1.Reader, _ros1_decoder, "`rosbag reindex {path}` recovers what can be read"),
    _Format(
        b"\x89MCAP0\r\n",
        _mcap_reader,
        _cdr_decoder,
        f"`mcap recover {{path}} -o recovered{SUFFIX}` saves what can be read",
    ),
)
