"""The ROS master of a tool, at which all its launches run one after another."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import rospy
from running import ROSCORE, running, wait_for_port

HERE = Path(__file__).resolve().parent
MISSION = str(HERE / "session.launch")
REJOINING = str(HERE / "rejoin.launch")
NODES = ("/simulation", "/scene")
CONTROLLERS = ("/robot_0/controller", "/robot_1/controller")
"""Controllers that roslaunch starts itself, in rejoin.launch."""
TEAM = "/controllers"
RECORDER = "/recorder"
"""`rosbag record`, with recorder:=rosbag."""


@contextmanager
def master(folder: Path) -> Iterator[int]:
    """Run a ROS master, of which this process is a node; yields its port. SIGTERM ends all that is running."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    with running(ROSCORE, folder) as core:
        wait_for_port(core.port)
        os.environ |= {"ROS_MASTER_URI": f"http://localhost:{core.port}", "ROS_HOSTNAME": "localhost"}
        rospy.init_node("faults", disable_signals=True)
        yield core.port
