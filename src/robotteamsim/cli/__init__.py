"""The command line: `robotteamsim --help`."""

import sys
from collections.abc import Sequence

__all__ = ["main"]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit status, see `command_line.main`."""
    try:
        from robotteamsim.cli import command_line  # takes a while, in which Ctrl-C is one line, too
    except KeyboardInterrupt:
        print("robotteamsim: interrupted", file=sys.stderr)
        return 130
    return command_line.main(arguments)
