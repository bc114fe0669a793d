"""The two formats of recordings: ROS 1 bags, and MCAP files with ROS 2 messages."""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

from rosbags import rosbag1, rosbag2
from rosbags.interfaces import MessageDefinition, MessageDefinitionFormat
from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from robotteamsim.errors import RecordingError
from robotteamsim.recording.bag_types import bag_typestore
from robotteamsim.recording.mcap_writer import SUFFIX

Reader = rosbag1.Reader | rosbag2.Reader
Decode = Callable[[bytes, str], Any]
"""Returns the message of data and the name of its type."""


class BagFormat(Protocol):
    """What differs between the formats. magic: the first bytes of each file."""

    magic: bytes

    def reader(self, path: Path) -> Reader:
        """Return a reader, which is not open yet. Raises: RecordingError: the file has the wrong name."""

    def decoder(self, connection: Any) -> Decode | None:
        """Return a function that reads the messages of a connection; None if its type cannot be read."""

    def remedy(self, path: Path) -> str:
        """Return the program that makes a damaged file readable, and what it does."""


class Ros1Format:
    """Bags of ROS 1."""

    magic = b"#ROSBAG V"

    def __init__(self) -> None:
        self._typestore = bag_typestore()

    def reader(self, path: Path) -> Reader:
        """Return a reader."""
        return rosbag1.Reader(path)

    def decoder(self, connection: Any) -> Decode | None:
        """Return a function that reads messages; types that are not ours are read as the bag defines them."""
        if self._is_ours(connection):
            return self._typestore.deserialize_ros1
        if connection.msgtype in get_typestore(Stores.ROS1_NOETIC).types:
            return None  # ROS's own types never change, so this is a different type of the same name.
        types = _own_types(Stores.ROS1_NOETIC, connection.msgtype, connection.msgdef)
        return None if types is None else types.deserialize_ros1

    def _is_ours(self, connection: Any) -> bool:
        if connection.msgtype not in self._typestore.types:
            return False
        _, digest = self._typestore.generate_msgdef(connection.msgtype)
        return connection.digest in (digest, "*")

    def remedy(self, path: Path) -> str:
        """Return the repair by ROS."""
        return f"`rosbag reindex {path}` recovers what can be read"


class McapFormat:
    """MCAP files of ROS 2; all types are read as the file defines them."""

    magic = b"\x89MCAP0\r\n"

    def reader(self, path: Path) -> Reader:
        """Return a reader. Raises: RecordingError: rosbags reads a single file only if its name ends in .mcap."""
        if path.suffix != SUFFIX:
            raise RecordingError(f"{path}: is an MCAP file; expected a name that ends in {SUFFIX}")
        return rosbag2.Reader(path)

    def decoder(self, connection: Any) -> Decode | None:
        """Return a function that reads messages; None for messages of another encoding than CDR."""
        if connection.ext.serialization_format != "cdr":
            return None
        types = _own_types(Stores.EMPTY, connection.msgtype, connection.msgdef)
        return None if types is None else types.deserialize_cdr

    def remedy(self, path: Path) -> str:
        """Return the repair by the program of the format's authors."""
        return f"`mcap recover {path} -o recovered{SUFFIX}` saves what can be read"


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
