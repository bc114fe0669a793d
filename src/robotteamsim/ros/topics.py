"""The topics that a node publishes, and the messages of those that it receives."""

import atexit
from functools import cache
from io import BytesIO
from typing import Any

import genpy
import rospy

from robotteamsim._ros_publisher import Publisher, shut_down, start

UNLIMITED = 0
"""Length of a queue that drops nothing, as steps in lockstep need."""


class RospyOutput:
    """A topic of a controller; without receivers, messages need not be built."""

    def __init__(self, topic: str, message_class: Any, *, latched: bool = False) -> None:
        """Advertise."""
        self._latched = latched
        self._publisher = rospy.Publisher(topic, message_class, tcp_nodelay=True, latch=latched, queue_size=UNLIMITED)
        self.publish = self._publisher.publish

    @property
    def wanted(self) -> bool:
        """Whether there is a receiver for the next message, now or (latched) later."""
        return self._latched or bool(self._publisher.get_num_connections() > 0)


class RoscppOutput:
    """A topic of the simulation, which has many: roscpp sends them all in one thread, and rospy in one for each."""

    def __init__(self, topic: str, message_class: Any, *, latched: bool = False) -> None:
        """Advertise, as the node `publishing_node()`."""
        _start()
        self._latched = latched
        self._publisher = Publisher(
            rospy.resolve_name(topic),
            message_class._type,
            message_class._md5sum,
            message_class._full_text,
            has_header=message_class._has_header,
            latched=latched,
        )
        self.publish_bytes = self._publisher.publish
        """Publishes a serialized message; roscpp numbers those with headers."""

    def publish(self, message: Any) -> None:
        """Publish a message of the topic's class."""
        buffer = BytesIO()
        message.serialize(buffer)
        self.publish_bytes(buffer.getvalue())

    @property
    def wanted(self) -> bool:
        """Whether there is a receiver for the next message, now or (latched) later."""
        return self._latched or self._publisher.num_subscribers > 0


def publishing_node() -> str:
    """Return the name of the node that publishes topics of this process's node through roscpp."""
    return f"{rospy.get_name()}_topics"


@cache
def _start() -> None:
    namespace, _, name = publishing_node().rpartition("/")
    start(name, namespace)
    atexit.register(shut_down)


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


def read(message_class: Any, data: bytes) -> Any:
    """Return a message of a class. Raises: ValueError: the bytes are not such a message."""
    try:
        return message_class().deserialize(data)
    except (genpy.DeserializationError, ValueError, OverflowError, MemoryError) as error:
        raise ValueError(f"not a {message_class.__name__}: {error}") from None
