"""Waiting for subscribers before the first step, which a recorder must get, too."""

import logging
import time
from collections.abc import Callable, Sequence
from typing import Any
from xmlrpc.client import ServerProxy

import rosgraph
import rospy

from robotteamsim.ros.topics import publishing_node

logger = logging.getLogger(__name__)

RECORDER = "recorder"
"""Name of the node that records a bag."""
QUIET_S = 1.0
"""The simulation starts when there was no new subscriber for this time [s, wall]."""

Connections = frozenset[tuple[str, str]]
"""Pairs of subscriber and topic."""


def wait_for_subscribers(recorded: Sequence[str], timeout_s: float, sleep: Callable[[float], object]) -> None:
    """Wait until the recorder receives what this node publishes, and nobody else subscribes any more.

    On a busy machine, a recorder may pause before it has connected to all topics, so they are counted. Other nodes that
    subscribe but never connect, such as one that was killed, are not waited for.
    Args: recorded: topics of the recorder; none if there is no recorder.
          timeout_s: after this time there is a warning instead [s, wall].
          sleep: waits [s, wall], and returns early when the node ends.
    """
    end_s = time.monotonic() + timeout_s
    connected: Connections | None = None
    while connected != (now_connected := _connections()) or _missing(recorded, now_connected):
        if time.monotonic() > end_s:
            if missing := _missing(recorded, now_connected):
                logger.warning("starting before the recorder has connected to %s", ", ".join(missing))
            return
        connected = now_connected
        sleep(QUIET_S)


def _connections() -> Connections:
    """Return who receives which topic of this node, as its slave API reports it."""
    reply: Any = ServerProxy(_master().lookupNode(publishing_node())).getBusInfo(rospy.get_name())
    _, _, links = reply
    return frozenset((link[1], link[4]) for link in links if link[2] == "o")


def _missing(recorded: Sequence[str], connected: Connections) -> list[str]:
    """Return the topics that the recorder does not receive yet."""
    if not recorded:
        return []
    recorder = rospy.resolve_name(f"/{RECORDER}")
    publishers, subscribers, _ = _master().getSystemState()
    own = {topic for topic, nodes in publishers if publishing_node() in nodes}
    subscribed = {topic for topic, nodes in subscribers if recorder in nodes}
    return [
        topic for topic in recorded if topic not in subscribed or (topic in own and (recorder, topic) not in connected)
    ]


def _master() -> Any:
    return rosgraph.Master(rospy.get_name())
