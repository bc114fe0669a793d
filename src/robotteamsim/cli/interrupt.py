"""Ctrl-C and SIGTERM."""

import contextlib
import os
import signal
import sys
import threading
from collections.abc import Iterator
from types import FrameType
from typing import Any, NoReturn

from robotteamsim.setup import Setup
from robotteamsim.simulation import Result, StepRecord

_SIGNALS = (signal.SIGINT, signal.SIGTERM)
_AGAIN_S = 0.05
"""After this time a signal that was ignored is sent again [s, wall]."""


class Terminated(KeyboardInterrupt):
    """SIGTERM: what cleans up after Ctrl-C also does after this."""


class InterruptBetweenSteps:
    """Ends a run on Ctrl-C or SIGTERM after the current step has been recorded; a second signal ends it at once."""

    def begin(self, setup: Setup) -> None:
        """Install the handler; only in the main thread, which alone can receive signals."""
        self._received = 0
        numbers = _SIGNALS if threading.current_thread() is threading.main_thread() else ()
        self._previous = {number: signal.signal(number, self._note) for number in numbers}

    def step(self, record: StepRecord) -> None:
        """End the run if a signal has come. Raises: KeyboardInterrupt, Terminated."""
        if self._received:
            raise _interrupt(self._received)

    def end(self, result: Result) -> None:
        """Restore the previous handlers."""
        self.abandon()

    def abandon(self) -> None:
        """Restore the previous handlers."""
        for number, handler in self._previous.items():
            signal.signal(number, handler)

    def _note(self, signal_number: int, frame: FrameType | None) -> None:
        if self._received:
            self.abandon()
            signal.raise_signal(signal_number)
        self._received = signal_number


@contextlib.contextmanager
def signals_raised() -> Iterator[list[KeyboardInterrupt]]:
    """Within the block SIGTERM raises Terminated, as Ctrl-C KeyboardInterrupt, so that files are closed.

    Yields a list of what was raised, because libraries may raise an error of their own instead. Where nothing can be
    raised, such as in callbacks of C, Python ignores it: then it is not printed, and the signal comes again a moment
    later. It does nothing outside the main thread, which alone receives signals.
    """
    raised: list[KeyboardInterrupt] = []
    if threading.current_thread() is not threading.main_thread():
        yield raised
        return

    def note(signal_number: int, frame: FrameType | None) -> NoReturn:
        raised.append(_interrupt(signal_number))
        raise raised[-1]

    print_ignored = sys.unraisablehook
    later: list[threading.Timer] = []

    def send_again(ignored: Any) -> None:
        if ignored.exc_value not in raised:
            print_ignored(ignored)
            return
        number = signal.SIGTERM if isinstance(ignored.exc_value, Terminated) else signal.SIGINT
        later.append(threading.Timer(_AGAIN_S, os.kill, (os.getpid(), number)))
        later[-1].start()

    sys.unraisablehook = send_again
    previous = {number: signal.signal(number, note) for number in _SIGNALS}
    try:
        yield raised
    finally:
        sys.unraisablehook = print_ignored
        for timer in later:
            timer.cancel()
        for number, handler in previous.items():
            signal.signal(number, handler)


def _interrupt(signal_number: int) -> KeyboardInterrupt:
    return Terminated() if signal_number == signal.SIGTERM else KeyboardInterrupt()
