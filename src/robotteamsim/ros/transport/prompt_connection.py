"""Sending messages without delay and in order over all topics, to subscribers however many, as rospy does not."""

from __future__ import annotations

import socket
import threading
from collections import deque
from typing import Any

import rosgraph.xmlrpc
import rospy.impl.tcpros_base
import rospy.topics

MAX_WAITING = 4096
"""So many connections may wait at once to be accepted."""


class PromptConnection:
    """Sends from the thread that publishes, and has a thread of its own only while the subscriber does not keep up.

    rospy either lets a stuck subscriber block the publisher, or hands every message to a thread per connection, and
    its time slice with it: then /clock can overtake the tf, odom and scan of its step, lockstep is slower, and a world
    of many robots waits most of the time (bench/ros_bench.py). Takes the place of rospy's QueuedConnection, and wraps
    a connection likewise.
    """

    def __init__(self, connection: Any, queue_size: int) -> None:
        """Args: queue_size: how many messages wait for a slow subscriber before the oldest is dropped; 0: all do."""
        self._connection = connection
        self._queue_size = queue_size
        self._lock = threading.Lock()
        # What the thread has yet to send; what it is sending stays in front.
        self._waiting: deque[bytes] = deque()

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return getattr(self._connection, name)

    def write_data(self, data: bytes | memoryview) -> bool:
        """Send the bytes of a message now, or queue what the socket does not take.

        Raises: what rospy's connection raises: the subscriber is gone.
        """
        with self._lock:
            if self._waiting:
                if 0 < self._queue_size < len(self._waiting):
                    del self._waiting[1]
                self._waiting.append(bytes(data))
                return True
            num_sent = self._send(data)
            if num_sent < len(data):
                self._waiting.append(bytes(data[num_sent:]))
                threading.Thread(target=self._relay, daemon=True).start()
        return True

    def _send(self, data: bytes | memoryview) -> int:
        """Return how many bytes the socket has taken."""
        connection = self._connection
        try:
            num_sent: int = connection.socket.send(data, socket.MSG_DONTWAIT)
        except BlockingIOError:
            return 0
        except (OSError, AttributeError):
            # The subscriber is gone: rospy knows what to do about it.
            connection.write_data(bytes(data))
            return len(data)
        connection.stat_bytes += num_sent
        connection.stat_num_msg += 1
        return num_sent

    def _relay(self) -> None:
        """Send what waits, until nothing does any more."""
        while True:
            try:
                self._connection.write_data(self._waiting[0])
            except Exception:  # Whatever it is, this subscriber is lost; the others are not.
                self._connection.close()
                with self._lock:
                    self._waiting.clear()
                return
            with self._lock:
                del self._waiting[0]
                if not self._waiting:
                    return


def send_promptly() -> None:
    """Let all publishers of this process send so from now on."""
    rospy.topics.QueuedConnection = PromptConnection


def accept_all_at_once() -> None:
    """Let any number of subscribers come at once; call it after rospy.init_node.

    rospy lets five wait. When one node subscribes to hundreds of topics the kernel drops others, and roscpp waits for
    those forever.
    """
    rospy.impl.tcpros_base._tcpros_server.tcp_ros_server.server_sock.listen(MAX_WAITING)


def answer_all_at_once() -> None:
    """Let any number of subscribers ask at once where to connect; call it before rospy.init_node."""
    rosgraph.xmlrpc.ThreadingXMLRPCServer.request_queue_size = MAX_WAITING
