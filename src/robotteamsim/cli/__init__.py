"""The command line: `robotteamsim --help`."""

import signal
import sys
from collections.abc import Sequence
from typing import NoReturn

__all__ = ["main", "run_and_exit"]


def run_and_exit() -> NoReturn:
    """Run one command and end the process with its exit status.

    Before and after the command, while modules are imported and Python cleans up, Ctrl-C ends it without a traceback.
    """
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(main())


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit status, see `command_line.main`."""
    from robotteamsim.cli import command_line  # takes a while

    return command_line.main(arguments)
