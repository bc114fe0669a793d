from __future__ import annotations

import socket
import threading

import pytest

from robotteamsim.ros.transport.prompt_connection import PromptConnection


class Connection:
    """What rospy gives: something with a socket that writes all of the data, and blocks until it can."""

    def __init__(self, end: socket.socket) -> None:
        self.socket = end
        self.done = False
        self.stat_bytes = 0
        self.stat_num_msg = 0
        self.threads: list[int] = []

    def write_data(self, data: bytes) -> bool:
        self.threads.append(threading.get_ident())
        self.socket.sendall(data)
        return True

    def close(self) -> None:
        self.done = True


@pytest.fixture
def ends():
    sender, receiver = socket.socketpair()
    receiver.settimeout(5.0)
    with sender, receiver:
        yield sender, receiver


def receive(receiver: socket.socket, length: int) -> bytes:
    data = b""
    while len(data) < length:
        data += receiver.recv(length - len(data))
    return data


def test_message_is_on_its_way_when_write_returns(ends):
    inner = Connection(ends[0])
    assert PromptConnection(inner, 0).write_data(b"scan")
    assert ends[1].recv(4, socket.MSG_DONTWAIT) == b"scan"
    assert (inner.stat_bytes, inner.stat_num_msg, inner.threads) == (4, 1, [])


def test_stuck_subscriber_does_not_block_and_gets_everything_in_order_later(ends):
    inner = Connection(ends[0])
    prompt = PromptConnection(inner, 0)
    messages = [bytes([number]) * 4096 for number in range(250)]
    for message in messages:
        prompt.write_data(message)
    assert receive(ends[1], 250 * 4096) == b"".join(messages)
    assert set(inner.threads).isdisjoint({threading.get_ident()})


def test_message_larger_than_the_socket_takes_does_not_block_and_arrives_whole(ends):
    message = bytes(range(256)) * 40_000
    prompt = PromptConnection(Connection(ends[0]), 0)
    prompt.write_data(memoryview(message))
    prompt.write_data(b"end")
    assert receive(ends[1], len(message) + 3) == message + b"end"


def test_bytes_that_wait_are_those_of_the_moment_they_were_sent(ends):
    data = bytearray(b"a" * 1_000_000)
    prompt = PromptConnection(Connection(ends[0]), 0)
    for letter in b"ab":
        data[:] = bytes([letter]) * len(data)
        prompt.write_data(memoryview(data))
    assert receive(ends[1], 2 * len(data)) == b"a" * len(data) + b"b" * len(data)


def test_queue_drops_the_oldest_whole_message_when_it_is_full(ends):
    prompt = PromptConnection(Connection(ends[0]), 1)
    large = b"l" * 10_000_000
    for message in (large, b"1", b"2", b"3"):
        prompt.write_data(message)
    assert receive(ends[1], len(large) + 1) == large + b"3"


def test_subscriber_that_is_gone_is_told_of_as_rospy_does(ends):
    ends[1].close()
    with pytest.raises(BrokenPipeError):
        PromptConnection(Connection(ends[0]), 0).write_data(b"scan")
