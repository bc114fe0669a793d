from __future__ import annotations

import socket
import threading

import pytest

from robotteamsim.ros.prompt_connection import PROMPT_BYTES, PromptConnection


class Connection:
    """What rospy gives: something with a socket that writes all of the data, and blocks until it can."""

    def __init__(self, end: socket.socket) -> None:
        self.socket = end
        self.done = False
        self.threads: list[int] = []

    def set_cleanup_callback(self, callback: object) -> None:
        self.cleanup = callback

    def write_data(self, data: bytes) -> bool:
        self.threads.append(threading.get_ident())
        self.socket.sendall(data)
        return True


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


@pytest.fixture
def connection(ends):
    inner = Connection(ends[0])
    prompt = PromptConnection(inner, 0)
    yield prompt, inner
    inner.done = True
    inner.cleanup(inner)


def test_message_is_on_its_way_when_write_returns(ends, connection):
    prompt, inner = connection
    assert prompt.write_data(b"scan")
    assert ends[1].recv(4, socket.MSG_DONTWAIT) == b"scan"
    assert inner.threads == [threading.get_ident()]


def test_stuck_subscriber_does_not_block_and_gets_everything_in_order_later(ends, connection):
    prompt, inner = connection
    messages = [bytes([number]) * 4096 for number in range(250)]
    for message in messages:
        prompt.write_data(message)
    assert receive(ends[1], 250 * 4096) == b"".join(messages)
    assert len(set(inner.threads)) == 2


def test_large_message_is_queued(ends, connection):
    prompt, inner = connection
    prompt.write_data(b"m" * (PROMPT_BYTES + 1))
    prompt.write_data(b"n")
    assert receive(ends[1], PROMPT_BYTES + 2) == b"m" * (PROMPT_BYTES + 1) + b"n"
    assert threading.get_ident() not in inner.threads
