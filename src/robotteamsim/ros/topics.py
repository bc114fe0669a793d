"""The topics that a node publishes."""

import atexit
import sys
import threading
from functools import cache

import rosgraph
import rospy

from robotteamsim._ros_publisher import Publisher, is_ok, shut_down, start
from robotteamsim.message_parts import RosMessage
from robotteamsim.recording.bag_types import message_type
from robotteamsim.ros.messages import bytes_class, message_class
from robotteamsim.ros.node import ParameterError, end, wait_for_shutdown

UNLIMITED = 0
"""Length of a queue that drops nothing, as steps in lockstep need."""
CHECK_S = 0.1
"""Interval of checks whether the node that publishes is still there [s, wall]."""


class RospyOutput:
    """A topic of most nodes; without receivers, messages need not be built."""

    def __init__(self, topic: str, type_name: str, *, latched: bool = False, queue_size: int = UNLIMITED) -> None:
        """Advertise. Args: queue_size: of messages that wait for a slow receiver."""
        self._latched, self._type, self._bytes = latched, message_type(type_name), bytes_class(type_name)
        self._publisher = rospy.Publisher(topic, self._bytes, tcp_nodelay=True, latch=latched, queue_size=queue_size)

    def publish(self, message: RosMessage) -> None:
        """As for all outputs."""
        self._publisher.publish(self._bytes(self._type.encode(message)))

    @property
    def wanted(self) -> bool:
        """Whether there is a receiver for the next message, now or (latched) later."""
        return self._latched or bool(self._publisher.get_num_connections() > 0)


class RoscppOutput:
    """A topic of the simulation, which has many: roscpp sends them all in one thread, and rospy in one for each."""

    def __init__(self, topic: str, type_name: str, *, latched: bool = False) -> None:
        """Advertise, as the node `publishing_node()`. Raises: ParameterError: it has another type already."""
        _start()
        self._latched, self._type, of_type = latched, message_type(type_name), message_class(type_name)
        try:
            self._publisher = Publisher(
                rospy.resolve_name(topic),
                of_type._type,
                of_type._md5sum,
                of_type._full_text,
                has_header=of_type._has_header,
                latched=latched,
            )
        except RuntimeError as error:
            raise ParameterError(str(error)) from None

    def publish(self, message: RosMessage) -> None:
        """As for all outputs; roscpp numbers messages with headers."""
        self._publisher.publish(self._type.encode(message))

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
