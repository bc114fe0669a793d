"""The topics that a node publishes, and the messages of those that it receives."""

import atexit
import sys
import threading
from functools import cache
from io import BytesIO
from typing import Any

import genpy
import rosgraph
import rospy

from robotteamsim._ros_publisher import Publisher, is_ok, shut_down, start
from robotteamsim.ros.node import ParameterError, end, wait_for_shutdown

UNLIMITED = 0
"""Length of a queue that drops nothing, as steps in lockstep need."""
CHECK_S = 0.1
"""Interval of checks whether the node that publishes is still there [s, wall]."""


class RospyOutput:
    """A topic of most nodes; without receivers, messages need not be built."""

    def __init__(self, topic: str, message_class: Any, *, latched: bool = False, queue_size: int = UNLIMITED) -> None:
        """Advertise. Args: queue_size: of messages that wait for a slow receiver."""
        self._latched = latched
        self._publisher = rospy.Publisher(topic, message_class, tcp_nodelay=True, latch=latched, queue_size=queue_size)
        self.publish = self._publisher.publish

    @property
    def wanted(self) -> bool:
        """Whether there is a receiver for the next message, now or (latched) later."""
        return self._latched or bool(self._publisher.get_num_connections() > 0)


class RoscppOutput:
    """A topic of the simulation, which has many: roscpp sends them all in one thread, and rospy in one for each."""

    def __init__(self, topic: str, message_class: Any, *, latched: bool = False) -> None:
        """Advertise, as the node `publishing_node()`. Raises: ParameterError: it has another type already."""
        _start()
        self._latched = latched
        try:
            self._publisher = Publisher(
                rospy.resolve_name(topic),
                message_class._type,
                message_class._md5sum,
                message_class._full_text,
                has_header=message_class._has_header,
                latched=latched,
            )
        except RuntimeError as error:
            raise ParameterError(str(error)) from None
        self.publish_bytes = self._publisher.publish
        """Publishes a serialized message; roscpp numbers those with headers."""

    def publish(self, message: Any) -> None:
        """Publish a message of the topic's class."""
        self.publish_bytes(serialized(message))

    @property
    def wanted(self) -> bool:
        """Whether there is a receiver for the next message, now or (latched) later."""
        return self._latched or self._publisher.num_subscribers > 0


def serialized(message: Any) -> bytes:
    """Return a message as it is sent."""
    buffer = BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


def publishing_node() -> str:
    """Return the name of the node that publishes topics of this process's node through roscpp."""
    return f"{rospy.get_name()}_topics"


@cache
def _start() -> None:
    namespace, _, name = publishing_node().rpartition("/")
    remappings = rosgraph.names.load_mappings(sys.argv)
    known = {key: remappings[key] for key in ("__master", "__ip", "__hostname") if key in remappings}
    try:
        start(name, known | {"__ns": namespace})
    except RuntimeError as error:
        raise ParameterError(f"{publishing_node()}: not a name of a node: {error}") from None
    threading.Thread(target=_end_with_it).start()
    atexit.register(shut_down)


def _end_with_it() -> None:
    """End this process's node when somebody else shuts down the one that publishes."""
    while not wait_for_shutdown(CHECK_S):
        if not is_ok():
            end()


@cache
def received_class(message_class: Any) -> Any:
    """Return a class for received messages of a type that only keeps their bytes, for `read`.

    A message that cannot be read is reported by the node that reads it; the connection stays open.
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
