"""A mission in ROS 2, and those who step and read it, for ros2_bench.py."""

from __future__ import annotations

import contextlib
import importlib
import os
import re
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.experimental.events_executor import EventsExecutor
from rclpy.qos import HistoryPolicy, QoSProfile


@contextlib.contextmanager
def network() -> Iterator[None]:
    """Nodes of this machine see each other."""
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    yield


class Mission:
    """A client of its services."""

    def __init__(self, starter: int) -> None:
        """Args: starter: id of the process whose first child is the simulation."""
        self._node = rclpy.create_node("bench")
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self._node)
        self._type = importlib.import_module("robotteamsim.srv").Step
        self._client = self._node.create_client(self._type, "/simulation/step")
        self._client.wait_for_service(60.0)
        self.pid = int(Path(f"/proc/{starter}/task/{starter}/children").read_text(encoding="utf-8").split()[0])

    def step(self, number: int) -> None:
        """Take some steps."""
        answer = self._client.call_async(self._type.Request(steps=number))
        self._executor.spin_until_future_complete(answer, 300.0)


@contextlib.contextmanager
def paused_mission(values: dict[str, Any], log: Any) -> Iterator[Mission]:
    """Start a mission that is as fast as possible, and paused before its first step. Args: values: options by name."""
    options = [part for key, value in values.items() if value is not True for part in (f"--{key}", str(value))]
    switches = [f"--{key}" for key, value in values.items() if value is True]
    command = (sys.executable, "-m", "robotteamsim.ros2", "garage_sar", *options, *switches)
    command += ("--speed", "0", "--paused", "--stays")
    with subprocess.Popen(command, stdout=log, stderr=log) as mission:
        rclpy.init()
        try:
            yield Mission(mission.pid)
        finally:
            mission.terminate()
            rclpy.shutdown()


def receive(pattern: str | None, count: Callable[[object], None], ready: Any, done: Any) -> int:
    """Receive messages as bytes until the end; return the number of topics."""
    rclpy.init()
    node = rclpy.create_node("bench_reader")
    deadline_s = time.monotonic() + 60.0
    while not node.count_publishers("/clock") and time.monotonic() < deadline_s:
        time.sleep(0.1)
    time.sleep(3.0)  # discovery of all topics
    profile = QoSProfile(depth=0, history=HistoryPolicy.KEEP_ALL)
    found = node.get_topic_names_and_types() if pattern else []
    # Hidden topics, such as the feedback of actions, have types that only rclpy makes.
    topics = [(name, kind) for name, (kind, *_) in found if "/_" not in name and re.fullmatch(str(pattern), name)]
    for name, kind in topics:
        package, _, message = kind.split("/")
        message_class = getattr(importlib.import_module(f"{package}.msg"), message)
        node.create_subscription(message_class, name, count, profile, raw=True)
    executor = EventsExecutor()
    executor.add_node(node)
    ready.set()
    while not done.is_set():
        executor.spin_once(timeout_sec=0.1)
    rclpy.shutdown()
    return len(topics)
