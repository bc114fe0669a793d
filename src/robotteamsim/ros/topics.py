"""The topics that a node publishes, and the messages of those that it receives."""

import logging
import struct
from collections.abc import Callable
from functools import cache
from io import BytesIO
from typing import Any

import genpy
import rospy
from std_msgs.msg import Header

logger = logging.getLogger(__name__)

UNLIMITED = 0
"""Length of a queue that drops nothing, as steps in lockstep need."""


class Output(rospy.SubscribeListener):  # type: ignore[misc]  # rospy has no types
    """A topic that a node publishes; without receivers, messages need not be built."""

    def __init__(
        self, topic: str, message_class: type, *, latched: bool = False, greeting: Callable[[], Any] | None = None
    ) -> None:
        """Advertise. greeting: makes a message when there is a new subscriber, or None; called in another thread."""
        super().__init__()
        self._greeting = greeting
        self._latched = latched
        self._publisher = rospy.Publisher(
            topic,
            message_class,
            subscriber_listener=None if greeting is None else self,
            tcp_nodelay=True,
            latch=latched,
            queue_size=UNLIMITED,
        )
        self.publish = self._publisher.publish

    @property
    def wanted(self) -> bool:
        """Whether there is a receiver for the next message, now or (latched) later."""
        return self._latched or bool(self._publisher.get_num_connections() > 0)

    def peer_subscribe(self, topic_name: str, topic_publish: Any, peer_publish: Callable[[Any], None]) -> None:
        """Greet a new subscriber.

        All receive the message: `peer_publish` must not be called while another thread publishes.
        """
        assert self._greeting is not None
        try:
            message = self._greeting()
        except Exception:  # The subscriber still receives later messages; the node continues.
            logger.exception("%s: the first message for a new subscriber could not be made", topic_name)
            return
        if message is not None:
            self.publish(message)


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
