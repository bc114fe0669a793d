"""The signals that end a program in order, after its files are closed."""

import signal
import sys


def ending_signals() -> tuple[signal.Signals, ...]:
    """Return SIGINT (Ctrl-C), SIGTERM, and SIGHUP (the terminal was closed) unless it is ignored, as under nohup."""
    if sys.platform == "win32" or signal.getsignal(signal.SIGHUP) == signal.SIG_IGN:
        return signal.SIGINT, signal.SIGTERM
    return signal.SIGINT, signal.SIGTERM, signal.SIGHUP
