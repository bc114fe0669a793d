"""Sending messages without delay and in order over all topics, as rospy does not."""

from __future__ import annotations

import select
from typing import Any

import rospy.topics
from rospy.impl.tcpros_pubsub import QueuedConnection

PROMPT_BYTES = 16 * 1024
"""A message up to this size goes into the free part of a socket's buffer whole."""


class PromptConnection(QueuedConnection):
    """Sends from the thread that publishes, for as long as the subscriber keeps up.

    rospy either lets a stuck subscriber block the publisher, or hands every message to a thread per connection: then
    /clock can overtake the tf, odom and scan of its step, and lockstep is slower (bench/ros_bench.py). This one
    hands over to its thread, for good, when the subscriber no longer keeps up or a message is large.
    """

    def __init__(self, connection: Any, queue_size: int) -> None:
        super().__init__(connection, queue_size)
        self._writable = select.poll()
        self._writable.register(connection.socket, select.POLLOUT)
        self._prompt = True

    def write_data(self, data: bytes) -> bool:
        """Send the bytes of a message now, or queue them."""
        self._prompt = self._prompt and len(data) <= PROMPT_BYTES and bool(self._writable.poll(0))
        return self._connection.write_data(data) if self._prompt else super().write_data(data)


def send_promptly() -> None:
    """Let all publishers of this process send so from now on."""
    rospy.topics.QueuedConnection = PromptConnection
