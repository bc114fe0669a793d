from __future__ import annotations

from types import SimpleNamespace

import pytest

from robotteamsim.ros.transport import step_receiver
from robotteamsim.ros.transport.step_receiver import StepReceiver
from robotteamsim.ros.transport.synchronizer import Channel, LatestSynchronizer, LockstepSynchronizer, Step


class Source:
    """Gives one batch of messages after the other, each at the end of its wait, and is closed after the last one."""

    def __init__(self, *batches: list[tuple[int, int, bytes]]) -> None:
        self._batches = list(batches)
        self.is_closed = False
        self.now_s = 0.0

    def take(self, timeout_s: float) -> list[tuple[int, int, bytes]]:
        self.now_s += timeout_s
        if not self._batches:
            self.is_closed = True
            return []
        return self._batches.pop(0)


def number(data: bytes) -> int:
    return int(data)


def lockstep_receiver(source: Source, lines: list[str]) -> StepReceiver:
    channels = (Channel("scan"), Channel("odom"))
    steps = LockstepSynchronizer(channels, step_ns=100, silence_limit_s=5.0)
    return StepReceiver(steps, source, [("scan", number), ("odom", number)], lines.append)


@pytest.fixture
def lines() -> list[str]:
    """What was warned of."""
    return []


def test_step_is_made_of_messages_that_come_in_any_batches(lines):
    receiver = lockstep_receiver(
        Source([(0, 100, b"1")], [], [(0, 200, b"2"), (1, 100, b"3")], [(1, 200, b"4")]), lines
    )
    assert receiver.take() == Step(100, False, {"scan": (1,), "odom": (3,)})
    assert receiver.take() == Step(200, False, {"scan": (2,), "odom": (4,)})


def test_there_is_no_step_any_more_when_the_source_is_closed(lines):
    receiver = lockstep_receiver(Source([(0, 100, b"1")]), lines)
    assert receiver.take() is None
    assert receiver.take() is None


def test_message_whose_stamp_no_header_could_repeat_is_ignored(lines):
    source = Source([(0, 2**32 * 10**9, b"0"), (0, 100, b"1"), (1, 100, b"2")])
    assert lockstep_receiver(source, lines).take().messages == {"scan": (1,), "odom": (2,)}
    assert lines == ["scan: ignoring messages that cannot be read: stamp: 4294967296 s; expected below 2^32 s"]


def test_message_that_cannot_be_read_is_ignored_with_one_warning(lines):
    source = Source([(0, 100, b"x"), (0, 100, b"y"), (0, 100, b"1"), (1, 100, b"2")])
    assert lockstep_receiver(source, lines).take().messages == {"scan": (1,), "odom": (2,)}
    assert lines == ["scan: ignoring messages that cannot be read: invalid literal for int() with base 10: b'x'"]


def test_messages_that_came_since_the_last_step_belong_to_the_next_one():
    steps = LatestSynchronizer([Channel("scan", needed=True)])
    source = Source([(0, 100, b"1")], [(0, 200, b"2"), (0, 300, b"3")], [])
    receiver = StepReceiver(steps, source, [("scan", number)], print)
    assert receiver.take().messages == {"scan": (1,)}
    assert receiver.take() == Step(300, False, {"scan": (2, 3)})


def test_long_wait_is_reported(lines, monkeypatch):
    source = Source([(0, 100, b"1")], *[[]] * 20)
    monkeypatch.setattr(step_receiver, "time", SimpleNamespace(monotonic=lambda: source.now_s))
    assert lockstep_receiver(source, lines).take() is None
    assert lines == ["waiting for odom"]
