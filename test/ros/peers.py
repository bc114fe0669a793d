"""Clients that try the transport: a subscriber of rospy, and one that speaks TCPROS by hand; and their master."""

from __future__ import annotations

import contextlib
import queue
import socket
import struct
import subprocess
import time
import xmlrpc.client
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import rosgraph
import rospy
from running import TIMEOUT_S, environment, wait_for_port

NODE = "/transport_test"
"""The node whose topics a `Wire` reads, unless it is given another."""


@contextlib.contextmanager
def master(folder: Path) -> Iterator[dict[str, str]]:
    """Run a master that this process uses, too; return the environment of other nodes."""
    variables = environment(folder)
    port = int(variables["ROS_MASTER_URI"].rpartition(":")[2])
    with pytest.MonkeyPatch.context() as patch:
        for name, value in variables.items():
            patch.setenv(name, value)
        with subprocess.Popen(["rosmaster", "--core", "-p", str(port)], stdout=subprocess.DEVNULL) as process:
            wait_for_port(port)
            yield variables
            process.terminate()


class Peer:
    """Keeps what a subscriber of rospy gets."""

    def __init__(self, topic: str, message_class: type) -> None:
        self._received: queue.Queue = queue.Queue()
        self._subscriber = rospy.Subscriber(topic, message_class, self._received.put, tcp_nodelay=True)

    def next(self) -> object:
        return self._received.get(timeout=TIMEOUT_S)

    def is_silent(self) -> bool:
        return self._received.empty()


class Wire:
    """A subscriber of one topic that reads its socket only when it is asked to."""

    def __init__(self, topic: str, message_class: type, uri: str = "") -> None:
        """Args: uri: of the node that publishes; empty: the master is asked."""
        uri = uri or rosgraph.Master("/test").lookupNode(NODE)
        _, _, (_, host, port) = xmlrpc.client.ServerProxy(uri).requestTopic("/wire", topic, [["TCPROS"]])
        self.socket = socket.create_connection((host, port), TIMEOUT_S)
        fields = {"callerid": "/wire", "topic": topic, "type": message_class._type, "md5sum": message_class._md5sum}
        lines = [f"{key}={value}".encode() for key, value in (fields | {"tcp_nodelay": "1"}).items()]
        self._send(b"".join(struct.pack("<I", len(line)) + line for line in lines))
        self.header = self.next()

    def _send(self, data: bytes) -> None:
        self.socket.sendall(struct.pack("<I", len(data)) + data)

    def next(self) -> bytes:
        """Return the next message, however long it takes to come."""
        (length,) = struct.unpack("<I", self._exactly(4, 0))
        return self._exactly(length, 0)

    def next_that_is_there(self) -> bytes:
        """Return the next message. Raises: BlockingIOError: it has not come."""
        (length,) = struct.unpack("<I", self._exactly(4, socket.MSG_DONTWAIT))
        return self._exactly(length, socket.MSG_DONTWAIT)

    def _exactly(self, length: int, flags: int) -> bytes:
        data = b""
        while len(data) < length:
            received = self.socket.recv(length - len(data), flags)
            assert received, "the publisher has closed the connection"
            data += received
        return data


def wait_until(holds: Callable[[], bool], what: str) -> None:
    deadline_s = time.monotonic() + TIMEOUT_S
    while not holds():
        assert time.monotonic() < deadline_s, f"{what} was waited for"
        time.sleep(0.01)
