"""Waits for the messages of the next step. Independent of ROS."""

import time
from collections.abc import Callable, Sequence
from typing import Any, Protocol

from robotteamsim.ros.transport.synchronizer import Step, StepSynchronizer

CHECK_PERIOD_S = 1.0
"""Interval of checks for missing messages during a wait [s, wall]."""

LATEST_STAMP_NS = 2**32 * 10**9 - 1
"""A header has 32 bits for the seconds; nanoseconds above 1e9 could exceed them."""

Decode = Callable[[bytes], Any]
"""Converts a serialized message to a value; raises ValueError if that is impossible."""


class MessageSource(Protocol):
    """The source of messages, such as `_ros_transport.MessageQueue`."""

    @property
    def is_closed(self) -> bool:
        """Whether there will be no more messages."""

    def take(self, timeout_s: float) -> list[tuple[int, int, bytes]]:
        """Return topic index, stamp [ns] and bytes of all new messages; waits for the first one [s, wall]."""


class StepReceiver:
    """Feeds a synchronizer with messages until it has a step."""

    def __init__(
        self,
        synchronizer: StepSynchronizer,
        source: MessageSource,
        channels: Sequence[tuple[str, Decode]],
        warn: Callable[[str], object],
    ) -> None:
        """Args: channels: by topic index, the name of a channel and the function that reads its messages."""
        self._synchronizer = synchronizer
        self._source = source
        self._channels = channels
        self._warn = warn
        self._unreadable: set[str] = set()

    def take(self) -> Step | None:
        """Wait for the next step and return it; None if the source is closed."""
        started_s = time.monotonic()
        check_s = started_s + CHECK_PERIOD_S
        self._receive(0.0)
        while not self._source.is_closed:
            if (step := self._synchronizer.take_step()) is not None:
                return step
            now_s = time.monotonic()
            if now_s < check_s:
                self._receive(check_s - now_s)
                continue
            check_s += CHECK_PERIOD_S
            for line in self._synchronizer.check_wait(now_s - started_s):
                self._warn(line)
        return None

    def _receive(self, timeout_s: float) -> None:
        for index, stamp_ns, data in self._source.take(timeout_s):
            name, decode = self._channels[index]
            try:
                check_stamp(stamp_ns)
                message = decode(data)
            except ValueError as error:
                if name not in self._unreadable:
                    self._unreadable.add(name)
                    self._warn(f"{name}: ignoring messages that cannot be read: {error}")
            else:
                self._synchronizer.add(name, stamp_ns, message)


def check_stamp(stamp_ns: int) -> None:
    """Raises: ValueError: the stamp does not fit into the header of an answer."""
    if stamp_ns > LATEST_STAMP_NS:
        raise ValueError(f"stamp: {stamp_ns / 1e9:.0f} s; expected below 2^32 s")
