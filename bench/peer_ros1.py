"""A mission in ROS 1, and those who step and read it, for ros2_bench.py."""

from __future__ import annotations

import contextlib
import importlib
import os
import re
import signal
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from typing import Any

import rospy
from ros_network_bench import pid_of
from ros_processes import ROSLAUNCH, free_port
from std_srvs.srv import Trigger

from robotteamsim.ros.master import wait_for_master

SLOWEST = 0.01
"""Until the mission is paused, its first step takes this part of real time."""


@contextlib.contextmanager
def network() -> Iterator[None]:
    """Run a master."""
    port = free_port()
    with tempfile.TemporaryDirectory() as folder:
        os.environ |= {"ROS_MASTER_URI": f"http://localhost:{port}", "ROS_HOME": folder, "ROS_LOG_DIR": folder}
        with subprocess.Popen(("rosmaster", "--core", "-p", str(port)), stdout=subprocess.DEVNULL) as master:
            try:
                wait_for_master()
                rospy.init_node("bench", disable_rostime=True, disable_signals=True)
                yield
            finally:
                master.terminate()


class Mission:
    """A client of its services."""

    def __init__(self) -> None:
        """Wait for the simulation, and pause it."""
        rospy.wait_for_service("/simulation/step", 120.0)
        # The reader, a process that imports this file, does not find them.
        services = importlib.import_module("robotteamsim.srv")
        rospy.ServiceProxy("/simulation/pause", Trigger)()
        rospy.ServiceProxy("/simulation/set_speed", services.SetSpeed)(0.0)
        self._step = rospy.ServiceProxy("/simulation/step", services.Step)
        self.pid = pid_of("simulation")

    def step(self, number: int) -> None:
        """Take some steps."""
        answer = self._step(number)
        assert answer.success, answer.message


@contextlib.contextmanager
def paused_mission(values: dict[str, Any], log: Any) -> Iterator[Mission]:
    """Start a mission that is as fast as possible, and paused at its first step. Args: values: arguments by name."""
    arguments = [f"{key}:={value}" for key, value in values.items()]
    command = (*ROSLAUNCH, "robotteamsim", "garage_sar.launch", *arguments)
    command += (f"speed:={SLOWEST}", "mission_stays:=true", "rviz:=false")
    with subprocess.Popen(command, stdout=log, stderr=log) as launch:
        try:
            yield Mission()
        finally:
            launch.send_signal(signal.SIGINT)


def receive(pattern: str | None, count: Callable[[object], None], ready: Any, done: Any) -> int:
    """Receive messages as bytes until the end; return the number of topics."""
    rospy.init_node("bench_reader", disable_rostime=True, disable_signals=True)
    found = rospy.get_published_topics() if pattern else []
    topics = [name for name, _ in found if re.fullmatch(str(pattern), name) and not name.startswith("/rosout")]
    for name in topics:
        rospy.Subscriber(name, rospy.AnyMsg, count, tcp_nodelay=True)
    time.sleep(3.0)  # connections to all topics
    ready.set()
    done.wait()
    rospy.signal_shutdown("done")
    return len(topics)
