"""The package's log on the console and in /rosout."""

import logging
from collections.abc import Callable, Sequence

Levels = Sequence[tuple[int, Callable[[str], object]]]
"""The lowest level of Python's logging for each function of ROS that logs a line; the highest level first."""


def forward_logging(levels: Levels) -> None:
    """Send the package's log to ROS."""
    package = logging.getLogger("robotteamsim")
    package.addHandler(_Rosout(levels))
    package.setLevel(logging.INFO)
    package.propagate = False


class _Rosout(logging.Handler):
    def __init__(self, levels: Levels) -> None:
        super().__init__(logging.INFO)
        self._levels = levels

    def emit(self, record: logging.LogRecord) -> None:
        log = next(log for level, log in self._levels if record.levelno >= level)
        log(self.format(record))
