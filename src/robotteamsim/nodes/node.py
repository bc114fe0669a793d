"""What nodes need of a version of ROS."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any, Protocol

from robotteamsim.errors import RobotTeamSimError
from robotteamsim.message_parts import RosMessage

KINDS = {bool: "true or false", int: "a whole number", float: "a number", str: "text"}
"""What is expected of a parameter, by the type of its default."""


class ParameterError(RobotTeamSimError):
    """A parameter of a node is missing or wrong."""


class Output(Protocol):
    """A topic that a node publishes."""

    @property
    def wanted(self) -> bool:
        """Whether there is a receiver for the next message, now or (latched) later."""

    def publish(self, message: RosMessage) -> None:
        """Publish a message."""


class Node(Protocol):
    """A node of one version of ROS: parameters, topics, services, and its end.

    Names of topics and services are complete, or begin with ~ and lie below the node's name. Types are named as in
    "nav_msgs/Odometry".
    """

    @property
    def last_words(self) -> str:
        """What the user should know about the end of a launch; "" for nothing."""

    def setting_name(self, key: str) -> str:
        """Return what messages call a setting that the nodes of a launch share."""

    def setting(self, key: str, default: Any) -> Any:
        """Return such a setting, of the type of its default. Raises: ParameterError."""

    def parameter(self, name: str, default: Any) -> Any:
        """Return a parameter of this node, of the type of its default. Raises: ParameterError.

        Names that begin with ~ are below the node's name; /use_sim_time is that of all nodes.
        """

    def change_setting(self, key: str, value: str) -> None:
        """Change a setting for all nodes."""

    def output(self, topic: str, type_name: str, *, latched: bool = False) -> Output:
        """Advertise a topic. Raises: ParameterError: it has another type already."""

    def listen(
        self,
        topic: str,
        type_name: str,
        receive: Callable[[bytes], None],
        *,
        latched: bool = False,
        lossy: bool = False,
        queue_size: int | None = None,
    ) -> None:
        """Subscribe. Args: receive: called with each message as it was sent, in another thread.

        latched: whether the publisher keeps the last message.  lossy: whether it may lose some, as sensors do in ROS 2.
        queue_size: of messages that wait; None: all of them.
        """

    def read(self, type_name: str, data: bytes) -> tuple[int, Any]:
        """Return the stamp of a message [ns], 0 without a header, and the message. Raises: ValueError."""

    def offer(self, name: str, type_name: str, serve: Callable[[Any], Mapping[str, Any]]) -> None:
        """Offer a service. Args: serve: returns the attributes of the response to a request."""

    def call(self, name: str, type_name: str, request: Mapping[str, Any]) -> Any:
        """Call a service that another node may offer, with attributes; return the response, or None without one."""

    def topics(self) -> Collection[str]:
        """Return the full names of the topics that somebody publishes or, in ROS 2, receives."""

    def wait_for_subscribers(self, recorded: Sequence[str], timeout_s: float, sleep: Callable[[float], object]) -> None:
        """Wait until no new subscriber comes, with a timeout [s, wall].

        Args: recorded: topics that the recorder must receive, too.
              sleep:    waits [s, wall], and returns early when the node ends.
        """

    def is_running(self) -> bool:
        """Whether the node is running and not shutting down."""

    def wait_for_shutdown(self, timeout_s: float) -> bool:
        """Wait until the node is shut down, with a timeout [s, wall]; return whether it was."""

    def on_shutdown(self, close: Callable[[], None]) -> None:
        """Register a callback for the shutdown; it must not block, because a signal handler may call it."""
