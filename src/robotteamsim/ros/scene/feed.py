"""Subscriptions of the 3D scene: messages are stored as bytes, and decoded only when they are drawn."""

import logging
import re
from collections.abc import Iterable, Sequence
from typing import Any

from robotteamsim import _ros_transport as roscpp
from robotteamsim.ros.transport.checks import reader
from robotteamsim.ros.transport.serialization import message_type

logger = logging.getLogger(__name__)

GROUND_TRUTH = "base_pose_ground_truth"


class Feed:
    """The messages of a topic since it was last read.

    A world that runs as fast as possible publishes a hundred times more than can be seen, and decoding is expensive.
    """

    def __init__(self, topic: str, message_class: Any, keep: int = 1) -> None:
        """Subscribe. Args: keep: largest number of messages between two calls of a reader; older ones are dropped."""
        self._topic = topic
        self._read = reader(message_class)
        self._warned = False
        self._queue = roscpp.MessageQueue()
        self._queue.subscribe(topic, message_type(message_class), keep)

    def take(self, at_most: int = 1_000_000) -> list[Any]:
        """Return the messages since the last call, oldest first: at most `at_most`, evenly spread, with the newest.

        Args: at_most: 1 for only the newest.
        """
        raw = [data for _, _, data in self._queue.take(0.0)]
        return [message for data in thinned(raw, at_most) for message in self._decoded(data)]

    def newest(self) -> Any | None:
        """Return the newest message since the last call, or None."""
        messages = self.take(1)
        return messages[-1] if messages else None

    def close(self) -> None:
        """Unsubscribe."""
        self._queue.unsubscribe()

    def _decoded(self, data: bytes) -> list[Any]:
        """Return the message, or nothing if it cannot be read."""
        try:
            return [self._read(data)]
        except ValueError as error:
            if not self._warned:
                self._warned = True
                logger.warning("%s: ignoring messages that cannot be read: %s", self._topic, error)
            return []


def thinned(items: Sequence[Any], at_most: int) -> list[Any]:
    """Return at most `at_most` >= 1 of the items, evenly spread, including the last one."""
    stride = -(-len(items) // at_most) or 1
    return list(items[::-1][::stride][::-1])


def robot_topics(published: Iterable[str], name: str = GROUND_TRUTH) -> dict[int, str]:
    """Return the prefix of the published topics of each robot that has a topic of this name, by id, in id order.

    "/robot_3/base_pose_ground_truth" gives {3: "/robot_3/"}; a single robot without a namespace is robot 0.
    """
    pattern = re.compile(rf"(/(?:robot_(\d+)/)?){name}")
    found = {}
    for topic in published:
        if match := pattern.fullmatch(topic):
            found[int(match[2] or 0)] = match[1]
    return dict(sorted(found.items()))
