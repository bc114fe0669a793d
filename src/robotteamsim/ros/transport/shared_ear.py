"""Hearing all topics of a node from one thread, as rospy does not."""

from __future__ import annotations

import select
import socket
import threading
from collections.abc import Callable
from typing import Any

from rospy.impl.tcpros_base import TCPROSTransport
from rospy.impl.tcpros_pubsub import TCPROSSub

Callback = Callable[[list[Any], Any], None]
"""What rospy calls with messages and the connection that they came by."""

READ_BYTES = 1 << 18
"""At most so much is read from a publisher before it is the next one's turn."""


class SharedEar:
    """Reads the sockets of all publishers that a node listens to, in one thread.

    rospy has a thread for each of them. The controllers of thirty robots in one process hear 1,800 messages a second
    over 180 connections: with a thread to wake for each, which then waits for the interpreter, the process changes
    threads 11,000 times a second, and the four nodes are a tenth to a quarter busier (bench/ros_team_bench.py).
    """

    def __init__(self) -> None:
        self._poll = select.epoll()
        self._lines: dict[int, _Line] = {}
        threading.Thread(target=self._listen, name="shared ear", daemon=True).start()

    def hear(self, connection: Any, callback: Callback) -> None:
        """Call back with what comes by a connection; return when nothing comes any more, or something is wrong.

        What was not understood by then is in `connection.read_buff`, where rospy goes on with it.
        """
        line = _Line(connection, callback)
        if not line.deliver():
            line.end()
            return
        number = line.socket.fileno()
        self._lines[number] = line
        self._poll.register(number, select.EPOLLIN)
        line.ended.wait()

    def _listen(self) -> None:
        while True:
            for number, _ in self._poll.poll():
                line = self._lines[number]
                if not line.read():
                    self._poll.unregister(number)
                    del self._lines[number]
                    line.end()


class _Line:
    """One connection, and the beginning of a message that is still to come whole."""

    def __init__(self, connection: Any, callback: Callback) -> None:
        # A copy: rospy may close its own, and its number may become that of another one.
        self.socket: socket.socket = connection.socket.dup()
        self.ended = threading.Event()
        self._connection = connection
        self._callback = callback
        # A latched message may have come with the header that rospy has read.
        self._data = bytearray(connection.read_buff.getvalue()[: connection.read_buff.tell()])
        connection.read_buff.seek(0)
        connection.read_buff.truncate()

    def read(self) -> bool:
        """Read what is there and call back with the messages that are whole; return whether more may come."""
        try:
            data = self.socket.recv(READ_BYTES, socket.MSG_DONTWAIT)
        except BlockingIOError:
            return True
        except OSError:
            return False
        self._connection.stat_bytes += len(data)
        self._data += data
        return bool(data) and self.deliver()

    def end(self) -> None:
        """Let go of the connection, and leave to rospy what was not understood."""
        if self._connection.read_buff is not None:  # else rospy has closed the connection
            self._connection.read_buff.write(self._data)
        self.socket.close()
        self.ended.set()

    def deliver(self) -> bool:
        """Call back with the messages that are whole; return whether all could be read."""
        connection, messages, start, understood = self._connection, [], 0, True
        while len(self._data) - start >= 4:
            end = start + 4 + int.from_bytes(self._data[start : start + 4], "little")
            if end > len(self._data):
                break
            try:
                message = connection.protocol.recv_data_class().deserialize(bytes(self._data[start + 4 : end]))
            except Exception:  # Whatever it is: rospy will come across it, too, and knows what to do about it.
                understood = False
                break
            message._connection_header = connection.header
            messages.append(message)
            start = end
        del self._data[:start]
        if messages and not connection.done:
            connection.stat_num_msg += len(messages)
            if connection.is_latched:
                connection.latch = messages[-1]
            self._callback(messages, connection)
        return understood


def hear_with_one_thread() -> None:
    """Let all subscribers of this process hear so from now on; their callbacks must not wait for each other."""
    ear, with_own_thread = SharedEar(), TCPROSTransport.receive_loop

    def receive_loop(connection: Any, callback: Callback) -> None:
        if isinstance(connection.protocol, TCPROSSub) and connection.socket is not None:
            ear.hear(connection, callback)
        with_own_thread(connection, callback)

    TCPROSTransport.receive_loop = receive_loop
