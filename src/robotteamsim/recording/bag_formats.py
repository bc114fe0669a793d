"""The two formats of recordings: ROS 1 bags, and MCAP files with ROS 2 messages."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

from rosbags import rosbag1, rosbag2
from rosbags.interfaces import MessageDefinitionFormat
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

    def complaint(self, path: Path, error: Exception) -> str:
        """Return one line about an error of rosbags: what is wrong with the file, and the remedy."""


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
        types = self._typestore if self._is_ours(connection) else self._own_types(connection)
        return None if types is None else types.deserialize_ros1

    def _is_ours(self, connection: Any) -> bool:
        if connection.msgtype not in self._typestore.types:
            return False
        _, digest = self._typestore.generate_msgdef(connection.msgtype)
        return connection.digest in (digest, "*")

    def _own_types(self, connection: Any) -> Typestore | None:
        """Return ROS's types and those that the bag defines itself, such as older versions of this package's types."""
        types = get_typestore(Stores.ROS1_NOETIC)
        if connection.msgtype in types.types:
            return None  # ROS's own types never change, so this is a different type of the same name.
        return types if _defined(connection, types) else None

    def complaint(self, path: Path, error: Exception) -> str:
        """Return one line; `rosbag reindex` is the remedy."""
        why = "is damaged"
        if isinstance(error, rosbag1.ReaderError):
            if "not indexed" in str(error):
                why = "has no index, because its recording was interrupted"
            elif "not supported" in str(error):
                return f"{path}: {str(error).rstrip('.')}"
        return f"{path}: {why}; `rosbag reindex {path}` recovers what can be read"


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
        types = get_typestore(Stores.EMPTY)
        is_cdr = connection.ext.serialization_format == "cdr"
        return types.deserialize_cdr if is_cdr and _defined(connection, types) else None

    def complaint(self, path: Path, error: Exception) -> str:
        """Return one line; `mcap recover` is the remedy."""
        if isinstance(error, rosbag2.ReaderError) and "Profile is not ros2" in str(error):
            return f"{path}: has no ROS 2 messages; expected an MCAP file with the profile ros2"
        why = "has no index, because its recording was interrupted or its end is missing"
        if not (isinstance(error, rosbag2.ReaderError) and "end magic" in str(error)):
            why = "is damaged"
        return f"{path}: {why}; `mcap recover {path} -o recovered{SUFFIX}` saves what can be read"


def _defined(connection: Any, types: Typestore) -> bool:
    """Add the types that a connection defines; return whether its own type is known then."""
    definition = connection.msgdef
    try:
        if definition.format is MessageDefinitionFormat.IDL:
            defined = get_types_from_idl(definition.data)
        else:
            defined = get_types_from_msg(definition.data, connection.msgtype)
        types.register({name: kind for name, kind in defined.items() if name not in types.types})
    except Exception:  # rosbags turns definitions into Python code: any error of that, such as SyntaxError
        return False
    return connection.msgtype in types.types
