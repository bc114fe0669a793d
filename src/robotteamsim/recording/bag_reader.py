"""Reads bags without ROS: one recording in one or several files, from any simulator or robot."""

from __future__ import annotations

import collections
import contextlib
import functools
import itertools
import sys
from collections.abc import Callable, Collection, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from rosbags import rosbag1, rosbag2
from rosbags.interfaces import MessageDefinition, MessageDefinitionFormat
from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

if sys.version_info >= (3, 14):
    from compression import zstd
else:
    from backports import zstd

from robotteamsim.errors import RecordingError
from robotteamsim.recording.bag_file import BagFile, DamagedFileError
from robotteamsim.recording.bag_paths import METADATA, files_of, is_bag
from robotteamsim.recording.bag_types import bag_typestore, defined_type
from robotteamsim.recording.mcap_writer import SUFFIX
from robotteamsim.recording.results import FILE_NAME
from robotteamsim.user_files import open_regular

Reader = rosbag1.Reader | rosbag2.Reader
Decode = Callable[[bytes], Any]
"""Returns the message of data."""


class _Format(NamedTuple):
    """What differs between the formats.

    magic:  the first bytes of each file; b"" for a folder.
    name:   of a file.  suffix: the end of its name, by which rosbags knows the format.
    remedy: the program that makes a damaged file readable.
    """

    magic: bytes
    name: str
    suffix: str
    remedy: str


class _Part(NamedTuple):
    """One open file."""

    path: Path
    reader: Reader
    format: _Format


class BagReader:
    """Reads the messages of ROS 1 bags, and of folders, MCAP and .db3 files of ROS 2; a context manager.

    They may be compressed. Several paths are the parts of one recording (`rosbag record --split`), in any order.
    late_ns: by topic, the time from the stamp of the header to that of recording [ns], of the message read so far in
             which it was the shortest; clocks that differ make it large. Messages without a stamp have none.
    unstamped: topics of messages, of those read so far, whose header has the stamp 0.
    """

    def __init__(self, paths: Sequence[Path]) -> None:
        self._paths = list(paths)
        self._stack = contextlib.ExitStack()
        self._parts: list[_Part] = []
        self._decoders: dict[Any, Decode | None] = {}
        self.late_ns: dict[str, int] = {}
        self.unstamped: set[str] = set()

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
                absent = {connection.topic for connection in chosen if connection.msgcount}
                for connection, time_ns, data in part.reader.messages(chosen):
                    topic = connection.topic
                    if topic not in topics:
                        raise ValueError("the index names another connection")
                    absent.discard(topic)
                    decode = self._decoder(part, connection)
                    assert decode is not None, f"{topic} is not known"
                    message: Any = decode(data)
                    if stamp_ns := _stamp_ns(message):
                        late_ns = time_ns - stamp_ns
                        self.late_ns[topic] = min(late_ns, self.late_ns.get(topic, late_ns), key=abs)
                    elif hasattr(message, "header"):
                        self.unstamped.add(topic)
                    yield topic, stamp_ns or time_ns, message
                if absent:
                    raise DamagedFileError(f"the messages of {min(absent)} are listed, but not there")

    def _decoder(self, part: _Part, connection: Any) -> Decode | None:
        """Return the function that reads the messages of a connection, or None if they cannot be read."""
        key = part.format.magic, connection.msgtype, connection.digest, connection.msgdef
        if key not in self._decoders:
            try:
                self._decoders[key] = (_ros1_decoder if part.format is _ROS1 else _cdr_decoder)(connection)
            except (ValueError, KeyError, RecursionError):  # a type with parts that are not read, or with itself as one
                self._decoders[key] = None
        return self._decoders[key]


@contextlib.contextmanager
def _open(path: Path) -> Iterator[_Part]:
    """Open one bag. Raises: RecordingError."""
    known = _format_of(path)
    part = _Part(path, (rosbag1.Reader if known is _ROS1 else rosbag2.Reader)(BagFile(path)), known)
    with _damage_reported(part):
        part.reader.open()
    try:
        yield part
    finally:
        part.reader.close()


def _format_of(path: Path) -> _Format:
    """Return the format of a file or folder. Raises: RecordingError: it is not a bag of ROS."""
    if path.is_dir():
        if (path / METADATA).is_file():
            return _FOLDER
        if (path / FILE_NAME).is_file():
            raise RecordingError(f"{path}: is a folder of `run --out`; expected a bag, such as one of `run --bag`")
        raise RecordingError(
            f"{path}: is a folder without {METADATA}; expected a bag (`ros2 bag reindex {path}` writes the file, or "
            "give the bags in the folder)"
        )
    try:
        with open_regular(path) as file:
            begin = file.read(_BEGIN)
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read: {error.strerror or error}; expected a bag") from None
    if begin.startswith(_ZSTD) or path.name == METADATA:
        raise RecordingError(f"{path}: cannot be read alone; expected the folder that contains it, with {METADATA}")
    known = next((one for one in _FILES if begin.startswith(one.magic)), None)
    if known is None:
        why = f"is none of {', '.join(one.name for one in _FILES)}" if begin else "is empty, expected a bag"
        raise RecordingError(f"{path}: {why}")
    if not path.name.endswith(known.suffix):
        raise RecordingError(f"{path}: is {known.name}; expected a name that ends in {known.suffix}")
    if known is _MCAP:
        _check_profile(path, begin)
    return known


def _check_profile(path: Path, begin: bytes) -> None:
    """Raises: RecordingError: an MCAP file does not say that its messages are those of ROS 2.

    After the magic bytes come opcode and length of the header, and the length of the profile [MCAP specification,
    Header (op=0x01)].
    """
    size = int.from_bytes(begin[17:21], "little")
    profile = begin[21 : 21 + size]
    if len(profile) != size or profile == b"ros2" or len(begin) < 21:
        return  # or damaged, which rosbags reports
    if profile == b"ros1":
        raise RecordingError(f"{path}: is an MCAP file with messages of ROS 1; expected those of ROS 2, or a ROS 1 bag")
    name = profile.decode("utf-8", "backslashreplace")
    raise RecordingError(f"{path}: is an MCAP file of another kind, such as JSON: its profile is '{name}', not 'ros2'")


@contextlib.contextmanager
def _damage_reported(part: _Part) -> Iterator[None]:
    """Convert the exceptions of rosbags and decompressors on damaged files to one line that names file and remedy."""
    try:
        yield
    except (GeneratorExit, RecordingError):
        raise
    except Exception as error:  # Damaged bytes cause AssertionError, IndexError, KeyError, struct.error and others.
        for file in filter(is_bag, files_of(part.path)) if part.format is _FOLDER else ():
            with BagReader([file]) as alone:  # of the damaged one, the line is that of the file
                collections.deque(alone.messages(set(filter(alone.is_known, alone.topics))), maxlen=0)
        why = "is damaged"
        if isinstance(error, DamagedFileError):
            why = f"is damaged: {error}"
        elif isinstance(error, MemoryError):  # a compressed part claims more than fits, or the bag is honest and large
            why = "is damaged, or has more data than the memory can hold"
        elif isinstance(error, KeyError) and part.format is _MCAP:  # also the encoding of a schema
            why = "is damaged, or has messages that are not of ROS 2"
        elif isinstance(error, rosbag1.ReaderError | rosbag2.ReaderError):
            # After a colon come Python's values and texts of other libraries.
            why = f"cannot be read: {' '.join(str(error).partition(':')[0].split()).rstrip('.')}"
        raise RecordingError(f"{part.path}: {why}; {part.format.remedy.format(path=part.path)}") from error


def _stamp_ns(message: Any) -> int:
    """Return the stamp of a message's header [ns], or 0 if it has none."""
    header = getattr(message, "header", None)
    return header.stamp if header else 0


def _decode(types: Typestore, name: str, *, is_cdr: bool) -> Decode:
    decode: Decode = defined_type(types, name, is_cdr=is_cdr).decode
    return decode


def _ros1_decoder(connection: Any) -> Decode | None:
    """Types that are not ours are read as the bag defines them."""
    ours = bag_typestore()
    if connection.msgtype in ours.types and connection.digest in (ours.generate_msgdef(connection.msgtype)[1], "*"):
        return _decode(ours, connection.msgtype, is_cdr=False)
    if connection.msgtype in get_typestore(Stores.ROS1_NOETIC).types:
        return None  # ROS's own types never change, so this is a different type of the same name.
    types = _own_types(Stores.ROS1_NOETIC, connection.msgtype, connection.msgdef)
    return None if types is None else _decode(types, connection.msgtype, is_cdr=False)


def _cdr_decoder(connection: Any) -> Decode | None:
    """Types are read as the file defines them, or if it does not, as ours; messages of other encodings are not read."""
    if connection.ext.serialization_format != "cdr":
        return None
    is_defined = connection.msgdef.format is not MessageDefinitionFormat.NONE  # not in .db3 files before ROS 2 Iron
    types: Typestore | None = bag_typestore(Stores.ROS2_HUMBLE)
    if is_defined:
        types = _own_types(Stores.EMPTY, connection.msgtype, connection.msgdef)
    if types is None or connection.msgtype not in types.types:
        return None
    read = _decode(types, connection.msgtype, is_cdr=True)
    # Messages may be compressed one by one, which only the yaml of their folder says.
    return lambda data: read(zstd.decompress(data) if data.startswith(_ZSTD) else data)


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


_BEGIN = 256
"""Bytes of a file that show its format."""
_ZSTD = b"\x28\xb5\x2f\xfd"
"""The first bytes of a frame [RFC 8878, 3.1.1]; those of CDR are 0 and at most 11."""
_FOLDER = _Format(
    b"", "a folder", "", f"`ros2 bag reindex {{path}}` writes {METADATA} again, from files that are not damaged"
)
_ROS1 = _Format(b"#ROSBAG V", "a ROS 1 bag", "", "`rosbag reindex {path}` recovers what can be read")
_MCAP = _Format(
    b"\x89MCAP0\r\n", "an MCAP file", SUFFIX, f"`mcap recover {{path}} -o recovered{SUFFIX}` saves what can be read"
)
_SQLITE = _Format(b"SQLite format 3\0", "a file of SQLite", ".db3", "`sqlite3 {path} .recover` prints what can be read")
_FILES = (_ROS1, _MCAP, _SQLITE)
