"""The end of a node."""

import contextlib
import logging
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterator

from robotteamsim.errors import RobotTeamSimError
from robotteamsim.extras import missing_extra

logger = logging.getLogger(__name__)


class Shutdown:
    """Whether a node should stop, and what to close then."""

    def __init__(self) -> None:
        # Reentrant, because the handler of a signal may interrupt a wait of the same thread.
        self._changed = threading.Condition()
        self._begun = False
        self._to_close: deque[Callable[[], None]] = deque()

    def begin(self) -> None:
        """Close everything; from any thread, and from a signal handler."""
        with self._changed:
            self._begun = True
            self._changed.notify_all()
        with contextlib.suppress(IndexError):
            while True:
                self._to_close.popleft()()

    def wait(self, timeout_s: float) -> bool:
        """Wait until the node is shut down, with a timeout [s, wall]; return whether it was."""
        with self._changed:
            return self._changed.wait_for(lambda: self._begun, timeout_s)

    @contextlib.contextmanager
    def after_mistakes(self) -> Iterator[None]:
        """End the process with one line and status 2 after a user's mistake, with status 1 without a package."""
        try:
            yield
        except RobotTeamSimError as error:
            if not self._begun:
                logger.critical("%s", error)
            sys.exit(2)
        except ModuleNotFoundError as error:
            line = missing_extra(error)
            if line is None:
                raise
            logger.critical("%s", line)
            sys.exit(1)

    def call(self, close: Callable[[], None]) -> None:
        """Register a callback for the shutdown; it must not block, because a signal handler may call it."""
        self._to_close.append(close)
        if self._begun:
            self.begin()
