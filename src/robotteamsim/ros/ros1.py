"""A node of ROS 1."""

from __future__ import annotations

import importlib
import logging
from collections.abc import Callable, Collection, Mapping
from typing import Any

import rospy

from robotteamsim.message_parts import RosMessage, stamp_ns
from robotteamsim.nodes.launched import ros1_setting_name
from robotteamsim.nodes.node import Output
from robotteamsim.recording.bag_types import message_type
from robotteamsim.ros.messages import bytes_class, message_class
from robotteamsim.ros.node import is_running, on_shutdown, parameter, wait_for_shutdown
from robotteamsim.ros.subscriptions import wait_for_subscribers
from robotteamsim.ros.topics import RospyOutput

LAST_WORDS = (
    "The mission has ended, and this ends the launch. roslaunch reports it in red, as 'REQUIRED process [simulation] "
    "has died'; this is the normal end."
)

logger = logging.getLogger(__name__)


class Ros1Node:
    """A `Node` of ROS 1: rospy, and roscpp for topics."""

    def __init__(self, kind: Callable[..., Output] = RospyOutput) -> None:
        """Args: kind: of the topics that it publishes."""
        self._kind = kind

    last_words = LAST_WORDS
    setting_name = staticmethod(ros1_setting_name)
    parameter = staticmethod(parameter)
    is_running = staticmethod(is_running)
    on_shutdown = staticmethod(on_shutdown)
    wait_for_shutdown = staticmethod(wait_for_shutdown)
    wait_for_subscribers = staticmethod(wait_for_subscribers)

    def setting(self, key: str, default: Any) -> Any:
        """As for all nodes."""
        return parameter(self.setting_name(key), default)

    def change_setting(self, key: str, value: str) -> None:
        """As for all nodes."""
        rospy.set_param(self.setting_name(key), value)

    def output(self, topic: str, type_name: str, *, latched: bool = False) -> Output:
        """As for all nodes."""
        return self._kind(topic, type_name, latched=latched)

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
        """As for all nodes."""
        kind = bytes_class(type_name)
        rospy.Subscriber(topic, kind, lambda message: receive(message.data), queue_size=queue_size, tcp_nodelay=True)

    def read(self, type_name: str, data: bytes) -> tuple[int, Any]:
        """As for all nodes."""
        message = message_type(type_name).decode(data)
        return stamp_ns(message), message

    def offer(self, name: str, type_name: str, serve: Callable[[Any], Mapping[str, Any]]) -> None:
        """As for all nodes."""
        service = _service_class(type_name)
        types = dict(zip(service._response_class.__slots__, service._response_class._slot_types, strict=True))

        def respond(request: Any) -> dict[str, Any]:
            return {
                key: _message(types[key], value) if isinstance(value, dict) else value
                for key, value in serve(request).items()
            }

        rospy.Service(name, service, respond)

    def call(self, name: str, type_name: str, request: Mapping[str, Any]) -> Any:
        """As for all nodes."""
        try:
            return rospy.ServiceProxy(name, _service_class(type_name))(**request)
        except rospy.ServiceException:
            return None

    def topics(self) -> Collection[str]:
        """As for all nodes."""
        return [name for name, _ in rospy.get_published_topics()]


def _message(type_name: str, message: RosMessage) -> Any:
    """Return a message as rospy has it."""
    return message_class(type_name)().deserialize(message_type(type_name).encode(message))


def _service_class(type_name: str) -> Any:
    package, name = type_name.split("/")
    return getattr(importlib.import_module(f"{package}.srv"), name)
