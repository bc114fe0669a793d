"""The topics that a node publishes, and the messages of those that it receives."""

import struct
from functools import cache
from io import BytesIO
from typing import Any

import genpy
import rospy
from std_msgs.msg import Header

UNLIMITED = 0
"""Length of a queue that drops nothing, as steps in lockstep need."""


class Output:
    """A topic that a node publishes; without receivers, messages need not be built."""

    def __init__(self, topic: str, message_class: type, *, latched: bool = False) -> None:
        """Advertise."""
        self._latched = latched
        self._publisher = rospy.Publisher(topic, message_class, tcp_nodelay=True, latch=latched, queue_size=UNLIMITED)
        self.publish = self._publisher.publish

    @property
    def wanted(self) -> bool:
        """Whether there is a receiver for the next message, now or (latched) later."""
        return self._latched or bool(self._publisher.get_num_connections() > 0)


@cache
def received_class(message_class: Any) -> Any:
    """Return a class for received messages of a type that only keeps their bytes, for `read`.

    A message that cannot be read is then the node's affair, and does not end the connection.
    """

    class Received(message_class):  # type: ignore[misc]
        def __init__(self) -> None:
            """Not that of the type, which would fill in every attribute."""

        def deserialize(self, data: bytes) -> Any:
            self.data = data
            return self

    return Received


@cache
def prepared_class(message_class: Any) -> Any:
    """Return a class for messages of a type whose bytes are ready, for the many messages of a team."""

    class Prepared(message_class):  # type: ignore[misc]
        def __init__(self, data: bytes) -> None:
            """Args: data: the message; of one with a header without its number, which rospy counts."""
            self.data = data
            self.header = Header()

        def serialize(self, buff: BytesIO) -> None:
            if "header" in message_class.__slots__:
                buff.write(struct.pack("<I", self.header.seq))
            buff.write(self.data)

    return Prepared


def read(message_class: Any, data: bytes) -> Any:
    """Return a message of a class. Raises: ValueError: the bytes are not such a message."""
    try:
        return message_class().deserialize(data)
    except (genpy.DeserializationError, ValueError, OverflowError, MemoryError) as error:
        raise ValueError(f"not a {message_class.__name__}: {error}") from None
