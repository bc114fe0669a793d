"""Start, log, parameters and end of a node. A process is one node, and roscpp its only ROS client."""

import contextlib
import logging
import signal
import sys
import threading
from collections import deque
from collections.abc import Callable
from typing import Any

import rosgraph

from robotteamsim import _ros_transport as roscpp
from robotteamsim.errors import RobotTeamSimError
from robotteamsim.extras import missing_extra

MASTER_PERIOD_S = 0.2
"""Interval of checks whether the master has started [s, wall]."""
WATCH_PERIOD_S = 0.1
"""Interval of checks whether the master has requested a shutdown [s, wall]."""

_KINDS = {bool: "true or false", int: "a whole number", float: "a number", str: "text"}

logger = logging.getLogger(__name__)


class ParameterError(RobotTeamSimError):
    """A parameter of a node is missing or wrong."""


class _Shutdown:
    """Whether the node should stop, and what to close then."""

    def __init__(self) -> None:
        self._begun = threading.Event()
        self._to_close: deque[Callable[[], None]] = deque()

    def begin(self) -> None:
        """Close everything; from any thread, and from a signal handler."""
        self._begun.set()
        with contextlib.suppress(IndexError):
            while True:
                self._to_close.popleft()()

    def wait(self, timeout_s: float) -> bool:
        """Wait until the node is shut down, with a timeout [s, wall]; return whether it was."""
        return self._begun.wait(timeout_s)

    def call(self, close: Callable[[], None]) -> None:
        """Register a callback for the shutdown; it must not block, because a signal handler may call it."""
        self._to_close.append(close)
        if self._begun.is_set():
            self.begin()

    def watch(self) -> None:
        """Shut down when roscpp does, on request of the master or of a new node with the same name."""
        while not self.wait(WATCH_PERIOD_S):
            if not roscpp.is_ok():
                self.begin()


_shutdown = _Shutdown()


def run(name: str, serve: Callable[[], None]) -> None:
    """Run a node until it is done or shut down; a user's mistake ends it with one line and status 2."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: _shutdown.begin())
    _wait_for_master()
    if not is_running():
        return
    roscpp.start_node(name, sys.argv)
    threading.Thread(target=_shutdown.watch, daemon=True).start()
    _forward_logging()
    try:
        serve()
    except RobotTeamSimError as error:
        if is_running():
            logger.critical("%s", error)
        sys.exit(2)
    except ModuleNotFoundError as error:
        line = missing_extra(error)
        if line is None:
            raise
        logger.critical("%s", line)
        sys.exit(1)
    finally:
        _shutdown.begin()
        roscpp.shut_down()


def is_running() -> bool:
    """Whether the node is running and not shutting down."""
    return not _shutdown.wait(0.0)


on_shutdown = _shutdown.call
wait_for_shutdown = _shutdown.wait


def node_name() -> str:
    """Return the full name of this node, such as "/world"."""
    return roscpp.node_name()


def parameter(name: str, default: Any) -> Any:
    """Return a parameter of the type of its default. Raises: ParameterError."""
    value = read_parameter(name, default)
    if isinstance(default, float) and isinstance(value, int) and not isinstance(value, bool):
        value = float(value)
    if isinstance(default, str) and isinstance(value, int | float):
        value = str(value)
    if type(value) is not type(default):
        raise ParameterError(f"{roscpp.resolved_name(name)}: {value!r}; expected {_KINDS[type(default)]}")
    return value


def read_parameter(name: str, default: Any) -> Any:
    """Return a parameter from the master."""
    try:
        return _master().getParam(roscpp.resolved_name(name))
    except rosgraph.MasterError:  # It is not set.
        return default


def set_parameter(name: str, value: Any) -> None:
    """Set a parameter."""
    _master().setParam(roscpp.resolved_name(name), value)


def published_topics() -> list[str]:
    """Return the full names of all published topics."""
    return [name for name, _ in _master().getPublishedTopics("")]


def _master() -> rosgraph.Master:
    return rosgraph.Master(roscpp.node_name())


def _wait_for_master() -> None:
    if rosgraph.is_master_online():
        return
    sys.stderr.write(f"waiting for the ROS master at {rosgraph.get_master_uri()}\n")
    while not _shutdown.wait(MASTER_PERIOD_S) and not rosgraph.is_master_online():
        pass


def _forward_logging() -> None:
    """Send the package's log to the console and to rosout."""
    package = logging.getLogger("robotteamsim")
    package.addHandler(_Rosout())
    package.setLevel(logging.INFO)
    package.propagate = False


class _Rosout(logging.Handler):
    _LEVELS = (
        (logging.CRITICAL, roscpp.Level.FATAL),
        (logging.ERROR, roscpp.Level.ERROR),
        (logging.WARNING, roscpp.Level.WARNING),
        (logging.INFO, roscpp.Level.INFO),
    )

    def emit(self, record: logging.LogRecord) -> None:
        level = next((level for number, level in self._LEVELS if record.levelno >= number), roscpp.Level.DEBUG)
        roscpp.log(level, self.format(record))
