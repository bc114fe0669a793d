"""The command line: `robotteamsim --help`."""

import gc
import logging
import signal
import sys
from collections.abc import Sequence
from typing import NoReturn

__all__ = ["main", "run_and_exit"]


def run_and_exit() -> NoReturn:
    """Run one command and end the process with its exit status.

    While Python imports the first modules and cleans up at the end, Ctrl-C ends it without a word. From the import of
    the command's own modules on, it prints "interrupted", and the status is 130.
    """
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    handler = logging.StreamHandler()  # of warnings about parts of users' packages, for example
    handler.setFormatter(logging.Formatter("robotteamsim: warning: %(message)s"))
    logging.getLogger("robotteamsim").addHandler(handler)
    gc.disable()  # until the command begins: searching what imports make for garbage takes a tenth of the start
    sys.exit(main())


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit status, see `command_line.main`."""
    from robotteamsim.cli import command_line  # takes a while

    return command_line.main(arguments)
