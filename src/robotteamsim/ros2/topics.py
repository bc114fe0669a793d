"""Topics and services in ROS 2: their types, qualities of service, and messages as the bytes that are sent."""

from __future__ import annotations

import importlib
import logging
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

from rclpy.node import Node as RclpyNode
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSPolicyKind, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.serialization import deserialize_message
from rosbags.typesys import Stores

from robotteamsim.message_parts import RosMessage
from robotteamsim.nodes.node import ParameterError
from robotteamsim.recording.bag_types import ROS2, message_type

QUEUE = 10
"""Number of messages of a topic that wait for a slow reader, and of a latched one that a late reader may get."""

SENSED = ("sensor_msgs/", "nav_msgs/Odometry")
BEST_EFFORT = QoSOverridingOptions((QoSPolicyKind.RELIABILITY,))
"""For what is sensed, such as over a wireless network; each topic with it adds a parameter to the node."""

logger = logging.getLogger(__name__)


def quality(*, latched: bool, lossy: bool = False, queue_size: int | None = QUEUE) -> QoSProfile:
    """Return the quality of service of a topic. Args: queue_size: None: of all messages."""
    durability = DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE
    keep = HistoryPolicy.KEEP_ALL if queue_size is None else HistoryPolicy.KEEP_LAST
    reliability = ReliabilityPolicy.BEST_EFFORT if lossy else ReliabilityPolicy.RELIABLE
    return QoSProfile(history=keep, depth=queue_size or 0, durability=durability, reliability=reliability)


def interface(kind: str, type_name: str) -> Any:
    """Return the class of rclpy of a type such as "nav_msgs/Odometry". Args: kind: msg or srv.

    Raises: ParameterError: it is not installed.
    """
    package, name = type_name.split("/")
    try:
        return getattr(importlib.import_module(f"{package}.{kind}"), name)
    except (ImportError, AttributeError):
        raise ParameterError(
            f"{package}/{kind}/{name} is not installed for this Python; expected a ROS 2 with {package} to be sourced "
            "(docs/ros2.md)"
        ) from None


@cache
def installed() -> Stores:
    """Return a version of ROS 2 with the types that are installed here, see `recording.bag_types.ROS2`."""
    has_variance = "variance" in interface("msg", "sensor_msgs/Range").get_fields_and_field_types()
    return ROS2 if has_variance else Stores.ROS2_HUMBLE


class Sender:
    """Sends the messages of a topic; one that cannot be sent, as to a receiver that is too slow, is counted."""

    def __init__(self, topic: str) -> None:
        self._topic = topic
        self.failed = 0
        """Number of messages that could not be sent."""

    def send(self, publish: Callable[[Any], object], message: Any) -> None:
        """Send a message. Args: publish: a method of rclpy."""
        try:
            publish(message)
        except RuntimeError as error:  # RCLError, which has no public name
            self.failed += 1
            if self.failed == 1:
                logger.warning("%s: a message could not be sent: %s", self._topic, error)


class Ros2Output:
    """A topic of a node."""

    def __init__(self, node: RclpyNode, topic: str, type_name: str, *, latched: bool) -> None:
        """Advertise. Raises: ParameterError: its type is not installed."""
        self.sender = Sender(topic)
        """Counts the messages that could not be sent."""
        self._latched = latched
        self._type = message_type(type_name, installed())
        self._publisher = node.create_publisher(
            interface("msg", type_name),
            topic,
            quality(latched=latched),
            # Users may ask for best effort: qos_overrides./robot_0/base_scan.publisher.reliability.
            qos_overriding_options=BEST_EFFORT if type_name.startswith(SENSED) and not latched else None,
        )

    @property
    def receivers(self) -> int:
        """Number of those who receive it now."""
        return int(self._publisher.get_subscription_count())

    @property
    def wanted(self) -> bool:
        """Whether there is a receiver for the next message, now or (latched) later."""
        return self._latched or self.receivers > 0

    def publish(self, message: RosMessage) -> None:
        """As for all outputs."""
        self.sender.send(self._publisher.publish, self._type.encode(message))


class StampedOutput:
    """A topic of geometry_msgs/TwistStamped, for a node that publishes Twist."""

    def __init__(self, output: Ros2Output) -> None:
        self._output = output

    @property
    def wanted(self) -> bool:
        """As for all outputs."""
        return self._output.wanted

    def publish(self, message: RosMessage) -> None:
        """Publish a Twist, with stamp 0."""
        self._output.publish({"twist": message})


def filled(response: Any, values: Mapping[str, Any]) -> Any:
    """Return the response of a service with these attributes."""
    types = response.get_fields_and_field_types()
    for name, value in values.items():
        if isinstance(value, dict):  # a message; a response of rclpy takes only those of its own
            value = deserialize_message(
                message_type(types[name], installed()).encode(value), interface("msg", types[name])
            )
        setattr(response, name, value)
    return response
