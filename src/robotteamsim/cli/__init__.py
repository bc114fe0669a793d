"""The command line: `robotteamsim --help`."""

import signal
import sys
from collections.abc import Sequence
from typing import NoReturn

__all__ = ["main", "run_and_exit"]


def run_and_exit() -> NoReturn:
    """Run one command and end the process with its exit status. Then Ctrl-C during Python's clean-up prints nothing."""
    try:
        sys.exit(main())
    finally:
        signal.signal(signal.SIGINT, signal.SIG_DFL)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit status, see `command_line.main`."""
    try:
        from robotteamsim.cli import command_line  # takes a while, in which Ctrl-C is one line, too
    except KeyboardInterrupt:
        print("robotteamsim: interrupted", file=sys.stderr)
        return 130
    return command_line.main(arguments)
