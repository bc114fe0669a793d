"""The console for tables on stdout."""

from typing import NoReturn

from rich.console import Console


class OutputConsole(Console):
    """Leaves a closed pipe to `main`, which has a status for it; rich would end with 1."""

    def on_broken_pipe(self) -> NoReturn:
        """Raises: BrokenPipeError."""
        raise BrokenPipeError
