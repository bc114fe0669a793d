"""A node of rclpy with which tests look at a simulation, and the start of one."""

from __future__ import annotations

import importlib
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile
from running import TIMEOUT_S

MISSION = (sys.executable, "-m", "robotteamsim.ros2")
ALL = QoSProfile(depth=0, history=HistoryPolicy.KEEP_ALL)
ALL_LATCHED = QoSProfile(depth=0, history=HistoryPolicy.KEEP_ALL, durability=DurabilityPolicy.TRANSIENT_LOCAL)
PERIOD_S = 0.01


def interface(kind: str, type_name: str) -> Any:
    """Return the class of a type such as "nav_msgs/Odometry"."""
    package, name = type_name.split("/")
    return getattr(importlib.import_module(f"{package}.{kind}"), name)


class Peer:
    """A node in a context of its own, which a thread serves."""

    def __init__(self, domain: int) -> None:
        self._context = rclpy.Context()
        rclpy.init(context=self._context, domain_id=domain)
        self.node = rclpy.create_node("peer", context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._closed = False
        self._thread = threading.Thread(target=self._spin)
        self._thread.start()

    def close(self) -> None:
        self._closed = True
        self._thread.join()
        self._executor.shutdown()
        self.node.destroy_node()
        rclpy.shutdown(context=self._context)

    def listen(self, topic: str, type_name: str, profile: QoSProfile = ALL, *, raw: bool = False) -> list[Any]:
        """Return a list to which every message is added."""
        received: list[Any] = []
        self.node.create_subscription(interface("msg", type_name), topic, received.append, profile, raw=raw)
        return received

    def call(self, service: str, type_name: str, /, **request: Any) -> Any:
        """Return the response of a service, for which it waits."""
        kind = interface("srv", type_name)
        client = self.node.create_client(kind, service)
        assert client.wait_for_service(TIMEOUT_S), f"no service {service}"
        future = client.call_async(kind.Request(**request))
        self.wait_until(future.done, f"a response of {service}")
        self.node.destroy_client(client)
        return future.result()

    def wait_until(self, holds: Callable[[], Any], what: str) -> Any:
        """Wait until something holds, and return it."""
        deadline_s = time.monotonic() + TIMEOUT_S
        while time.monotonic() < deadline_s:
            if found := holds():
                return found
            time.sleep(PERIOD_S)
        raise AssertionError(f"{what} did not come")

    def _spin(self) -> None:
        while not self._closed:
            self._executor.spin_once(timeout_sec=0.1)
