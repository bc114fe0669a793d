from __future__ import annotations

import io
import queue
import socket
import threading
from collections.abc import Callable, Iterator
from types import SimpleNamespace

import pytest
from std_msgs.msg import String

from robotteamsim.ros.transport.shared_ear import SharedEar

PATIENCE_S = 5.0


class Broken(String):
    def deserialize(self, data):
        if b"broken" in data:
            raise ValueError("cannot be read")
        return super().deserialize(data)


class Heard:
    """A connection as rospy has it, and a thread of rospy's that lets the ear hear it."""

    def __init__(
        self, ear: SharedEar, message_class: type = String, *, latched: bool = False, already_read: bytes = b""
    ) -> None:
        self.publisher, own = socket.socketpair()
        self.connection = SimpleNamespace(
            socket=own,
            protocol=SimpleNamespace(recv_data_class=message_class),
            header={"topic": "/talk"},
            done=False,
            is_latched=latched,
            latch=None,
            stat_bytes=0,
            stat_num_msg=0,
            read_buff=io.BytesIO(),
        )
        self.connection.read_buff.write(already_read)
        self.calls: queue.Queue[tuple[list[str], str]] = queue.Queue()
        self.thread = threading.Thread(target=ear.hear, args=(self.connection, self._put), daemon=True)
        self.thread.start()

    def _put(self, messages, connection):
        assert connection is self.connection
        self.calls.put(([message.data for message in messages], threading.current_thread().name))

    def texts(self, count: int) -> list[str]:
        """Wait for so many messages, and return them in the order of coming."""
        texts: list[str] = []
        while len(texts) < count:
            texts += self.calls.get(timeout=PATIENCE_S)[0]
        return texts


def framed(text: str) -> bytes:
    buffer = io.BytesIO()
    String(text).serialize(buffer)
    return len(buffer.getvalue()).to_bytes(4, "little") + buffer.getvalue()


@pytest.fixture
def hear() -> Iterator[Callable[..., Heard]]:
    """Connections that one ear hears; keywords as of `Heard`."""
    ear, connected = SharedEar(), []

    def make(*arguments, **keywords) -> Heard:
        connected.append(Heard(ear, *arguments, **keywords))
        return connected[-1]

    yield make
    for heard in connected:
        heard.publisher.close()
        heard.thread.join(PATIENCE_S)
        heard.connection.socket.close()


def test_messages_come_whole_and_in_order_however_they_are_cut(hear):
    heard = hear()
    data = b"".join(framed(f"message {number}") for number in range(20))
    for start in range(0, len(data), 7):
        heard.publisher.sendall(data[start : start + 7])
    assert heard.texts(20) == [f"message {number}" for number in range(20)]
    assert heard.connection.stat_num_msg == 20
    assert heard.connection.stat_bytes == len(data)


def test_what_came_with_the_header_is_not_lost(hear):
    latched, cut = framed("latched"), framed("cut")
    heard = hear(already_read=latched + cut[:5])
    assert heard.texts(1) == ["latched"]
    heard.publisher.sendall(cut[5:])
    assert heard.texts(1) == ["cut"]


def test_what_came_with_the_header_and_cannot_be_read_is_left_to_rospy(hear):
    broken = framed("broken")
    heard = hear(Broken, already_read=broken)
    heard.thread.join(PATIENCE_S)
    assert not heard.thread.is_alive()
    assert heard.connection.read_buff.getvalue() == broken


def test_message_larger_than_one_read_comes_whole(hear):
    heard = hear()
    text = "x" * 1_000_000
    sender = threading.Thread(target=heard.publisher.sendall, args=(framed(text) + framed("end"),))
    sender.start()
    assert heard.texts(2) == [text, "end"]
    sender.join(PATIENCE_S)


def test_all_connections_are_heard_by_one_thread(hear):
    several = [hear() for _ in range(30)]
    for number, heard in enumerate(several):
        heard.publisher.sendall(framed(str(number)))
    calls = [heard.calls.get(timeout=PATIENCE_S) for heard in several]
    assert [texts for texts, _ in calls] == [[str(number)] for number in range(30)]
    assert {name for _, name in calls} == {"shared ear"}


def test_last_message_of_a_latched_topic_is_kept_and_has_its_header(hear):
    heard = hear(latched=True)
    heard.publisher.sendall(framed("first") + framed("last"))
    heard.texts(2)
    assert heard.connection.latch.data == "last"
    assert heard.connection.latch._connection_header == {"topic": "/talk"}


def test_rospy_goes_on_where_the_publisher_leaves(hear):
    heard = hear()
    whole, rest = framed("whole"), framed("cut off")[:6]
    heard.publisher.sendall(whole + rest)
    heard.publisher.close()
    heard.thread.join(PATIENCE_S)
    assert not heard.thread.is_alive()
    assert heard.texts(1) == ["whole"]
    assert heard.connection.read_buff.getvalue() == rest
    assert heard.connection.socket.recv(1) == b""


def test_rospy_goes_on_with_what_cannot_be_read_and_others_are_heard_on(hear):
    heard, other = hear(Broken), hear()
    rest = framed("broken") + framed("after")
    heard.publisher.sendall(framed("sound") + rest)
    heard.thread.join(PATIENCE_S)
    assert not heard.thread.is_alive()
    assert heard.texts(1) == ["sound"]
    assert heard.connection.read_buff.getvalue() == rest
    other.publisher.sendall(framed("still there"))
    assert other.texts(1) == ["still there"]


def test_connection_that_is_closed_here_is_let_go_of_and_others_are_heard_on(hear):
    heard, other = hear(), hear()
    heard.publisher.sendall(framed("before"))
    assert heard.texts(1) == ["before"]
    heard.connection.done, heard.connection.read_buff = True, None
    heard.connection.socket.shutdown(socket.SHUT_RDWR)
    heard.connection.socket.close()
    heard.thread.join(PATIENCE_S)
    assert not heard.thread.is_alive()
    other.publisher.sendall(framed("still there"))
    assert other.texts(1) == ["still there"]
