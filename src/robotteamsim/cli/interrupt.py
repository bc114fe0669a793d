"""Ctrl-C, SIGTERM, and SIGHUP of a closed terminal."""

from __future__ import annotations

import contextlib
import signal
import sys
import threading
from collections.abc import Iterator
from types import FrameType
from typing import TYPE_CHECKING, Any

from robotteamsim.cli.streams import leave_closed_terminal
from robotteamsim.ending import ending_signals

if TYPE_CHECKING:
    from robotteamsim.setup import Setup
    from robotteamsim.simulation import Result, StepRecord


class Terminated(KeyboardInterrupt):
    """SIGTERM: what cleans up after Ctrl-C also does after this."""


class HungUp(Terminated):
    """SIGHUP."""


class InterruptBetweenSteps:
    """Ends a run on a signal after the current step has been recorded; a second Ctrl-C ends it at once.

    Further signals SIGTERM and SIGHUP are ignored while files are closed: `timeout` sends SIGTERM twice, and both the
    shell and the kernel send SIGHUP when a terminal is closed.
    """

    def begin(self, setup: Setup) -> None:
        """Install the handler; only in the main thread, which alone can receive signals."""
        self._received = 0
        numbers = ending_signals() if threading.current_thread() is threading.main_thread() else ()
        self._previous = {number: signal.signal(number, self._note) for number in numbers}

    def step(self, record: StepRecord) -> None:
        """End the run if a signal has come. Raises: KeyboardInterrupt, Terminated, HungUp."""
        if self._received:
            raise _interrupt(self._received)

    def end(self, result: Result) -> None:
        """Restore the previous handlers."""
        self.abandon()

    def abandon(self) -> None:
        """Restore the previous handlers; after a signal only that of Ctrl-C, for the command ends."""
        for number, handler in self._previous.items():
            if not self._received or number == signal.SIGINT:
                signal.signal(number, handler)

    def _note(self, signal_number: int, frame: FrameType | None) -> None:
        if not self._received:
            leave_closed_terminal()
            self._received = signal_number
        elif signal_number == signal.SIGINT:
            self.abandon()
            signal.raise_signal(signal_number)


@contextlib.contextmanager
def signals_raised() -> Iterator[list[KeyboardInterrupt]]:
    """Within the block SIGTERM raises Terminated and SIGHUP HungUp, as Ctrl-C KeyboardInterrupt: files are closed.

    Yields a list of what was raised, because libraries may raise an error of their own instead. After the first signal
    only Ctrl-C raises again. Where nothing can be raised, such as in callbacks of C, Python ignores it, and would print
    that; then the next signal ends the command. It does nothing outside the main thread, which alone receives signals.
    """
    raised: list[KeyboardInterrupt] = []
    lost: list[KeyboardInterrupt] = []
    if threading.current_thread() is not threading.main_thread():
        yield raised
        return

    def note(signal_number: int, frame: FrameType | None) -> None:
        if raised != lost and signal_number != signal.SIGINT:
            return
        leave_closed_terminal()
        raised.append(_interrupt(signal_number))
        raise raised[-1]

    print_ignored = sys.unraisablehook

    def note_ignored(ignored: Any) -> None:
        if ignored.exc_value in raised:
            lost.append(ignored.exc_value)
        else:
            print_ignored(ignored)

    sys.unraisablehook = note_ignored
    previous = {number: signal.signal(number, note) for number in ending_signals()}
    try:
        yield raised
    finally:
        sys.unraisablehook = print_ignored
        for number, handler in previous.items():
            signal.signal(number, handler)


def _interrupt(signal_number: int) -> KeyboardInterrupt:
    if signal_number == signal.SIGINT:
        return KeyboardInterrupt()
    return Terminated() if signal_number == signal.SIGTERM else HungUp()
