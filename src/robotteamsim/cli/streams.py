"""The standard streams, also closed, full, or in another encoding."""

import contextlib
import io
import os
import sys


def open_streams() -> None:
    """Make stdout and stderr usable.

    A closed one is replaced by /dev/null: print would otherwise write errors to stdout, and the next file to be opened
    would take its number. One that another program has left without blocking waits for its reader again. Characters
    that the encoding does not have are escaped.
    """
    for name, number in (("stdout", 1), ("stderr", 2)):
        if getattr(sys, name) is None:
            _open_null(number)
            setattr(sys, name, os.fdopen(number, "w"))
        if sys.platform != "win32":
            with contextlib.suppress(OSError):  # a stream without a file
                os.set_blocking(number, True)
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")


def close_stdout() -> None:
    """Discard what is left in the buffer of stdout; Python would otherwise report an error when it flushes at exit."""
    try:
        _open_null(sys.stdout.fileno())
    except (OSError, ValueError):  # a stream without a file, as in tests
        return


def leave_closed_terminal() -> None:
    """Discard what is written to a terminal that was closed; each write would be an error, and files stay open."""
    for number in (1, 2):
        try:
            os.write(number, b"")
        except OSError:
            _open_null(number)


def _open_null(number: int) -> None:
    null = os.open(os.devnull, os.O_WRONLY)
    if null != number:
        os.dup2(null, number)
        os.close(null)
