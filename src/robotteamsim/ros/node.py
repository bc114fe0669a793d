"""Start, log, parameters and end of a node."""

import logging
import signal
import threading
from collections.abc import Callable
from typing import Any

import rospy

from robotteamsim.ending import ending_signals
from robotteamsim.nodes.node import KINDS, ParameterError
from robotteamsim.nodes.rosout import forward_logging
from robotteamsim.nodes.shutdown import Shutdown
from robotteamsim.ros.master import wait_for_master

UNREGISTER_TIMEOUT_S = 5.0
"""A node waits this long for the end of its registration [s, wall]."""

__all__ = [
    "ParameterError",
    "end",
    "is_running",
    "on_shutdown",
    "parameter",
    "run",
    "wait_for_shutdown",
]


class _Shutdown(Shutdown):
    """The end of a node of rospy."""

    def __init__(self) -> None:
        super().__init__()
        self._unregistering = threading.current_thread()

    def begin_by_rospy(self) -> None:
        """Close everything; in this thread, often one of its own, rospy unregisters the node next."""
        self._unregistering = threading.current_thread()
        self.begin()

    def finish(self) -> None:
        """Wait until the node is unregistered; the end of the process would stop that."""
        if self._unregistering is not threading.current_thread():
            self._unregistering.join(UNREGISTER_TIMEOUT_S)


_shutdown = _Shutdown()


def run(name: str, serve: Callable[[], None]) -> None:
    """Run a node until it is done or shut down; a user's mistake ends it with one line and status 2."""
    for number in ending_signals():
        signal.signal(number, lambda *_: _shutdown.begin())
    wait_for_master(_shutdown.wait)
    if not is_running():
        return
    # Nodes need no time but that of their messages.
    rospy.init_node(name, disable_signals=True, disable_rostime=True)
    rospy.on_shutdown(_shutdown.begin_by_rospy)
    levels = (rospy.logfatal, rospy.logerr, rospy.logwarn, rospy.loginfo)
    forward_logging(tuple(zip((logging.CRITICAL, logging.ERROR, logging.WARNING, logging.INFO), levels, strict=True)))
    try:
        with _shutdown.after_mistakes():
            serve()
    finally:
        _shutdown.begin()
        rospy.signal_shutdown("the node is done")
        _shutdown.finish()


def is_running() -> bool:
    """Whether the node is running and not shutting down."""
    return not _shutdown.wait(0.0)


end = _shutdown.begin
on_shutdown = _shutdown.call
wait_for_shutdown = _shutdown.wait


def parameter(name: str, default: Any) -> Any:
    """Return a parameter of the type of its default. Raises: ParameterError."""
    value = rospy.get_param(name, default)
    if isinstance(default, float) and isinstance(value, int) and not isinstance(value, bool):
        value = float(value)
    if isinstance(default, str) and isinstance(value, int | float):
        value = str(value)
    if type(value) is not type(default):
        raise ParameterError(f"{rospy.resolve_name(name)}: {value!r}; expected {KINDS[type(default)]}")
    return value
