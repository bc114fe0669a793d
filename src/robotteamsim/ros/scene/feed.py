"""Topics as the 3D scene reads them: kept as bytes, decoded only when they are drawn."""

import logging
import re
from collections.abc import Iterable, Sequence
from typing import Any

from robotteamsim import _ros_transport as roscpp
from robotteamsim.ros.transport.serialization import deserialized, message_type

logger = logging.getLogger(__name__)

GROUND_TRUTH = "base_pose_ground_truth"


class Feed:
    """What came on a topic since it was last read.

    A world that runs flat out sends a hundred times more than can be seen, and decoding is expensive.
    """

    def __init__(self, topic: str, message_class: Any, keep: int = 1) -> None:
        """Subscribe; of more than `keep` messages between two readings the oldest are dropped."""
        self._class = message_class
        self._queue = roscpp.MessageQueue()
        self._queue.subscribe(topic, message_type(message_class), keep)

    def take(self, at_most: int = 1_000_000) -> list[Any]:
        """Return the messages since the last call, oldest first; at most so many, evenly spread, the newest included.

        Args: at_most: 1 for the newest alone.
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
        """Return the message, or nothing where it cannot be read."""
        try:
            return [deserialized(self._class, data)]
        except ValueError:
            logger.warning("ignoring a message that cannot be read", exc_info=True)
            return []


def thinned(items: Sequence[Any], at_most: int) -> list[Any]:
    """Return at most so many of the items, evenly spread, with the last one among them; at_most >= 1."""
    stride = -(-len(items) // at_most) or 1
    return list(items[::-1][::stride][::-1])


def robot_topics(published: Iterable[str]) -> dict[int, str]:
    """Return the prefix of the topics of each robot that somebody publishes, by id, in id order.

    "/robot_3/base_pose_ground_truth" gives {3: "/robot_3/"}; a lone robot without a namespace counts as robot 0.
    """
    pattern = re.compile(rf"(/(?:robot_(\d+)/)?){GROUND_TRUTH}")
    found = {}
    for topic in published:
        if match := pattern.fullmatch(topic):
            found[int(match[2] or 0)] = match[1]
    return dict(sorted(found.items()))
