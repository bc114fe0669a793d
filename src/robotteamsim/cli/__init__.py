"""The command line: `robotteamsim --help`."""

from robotteamsim.cli.main import main

__all__ = ["main"]
