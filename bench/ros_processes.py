"""Processes of ROS that measurements start and watch."""

from __future__ import annotations

import os
import socket
import sys
from pathlib import Path

ROSLAUNCH = (sys.executable, "-c", "import roslaunch; roslaunch.main()")
GRACE_S = 30
"""Time in which a process ends after a signal [s]."""


def free_port() -> int:
    """Return a port that nobody listens at."""
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        return int(probe.getsockname()[1])


def environment(folder: str) -> tuple[int, dict[str, str]]:
    """Return a free port for a master, and an environment in which nothing is left outside the folder."""
    port = free_port()
    uri = {"ROS_MASTER_URI": f"http://localhost:{port}", "ROS_HOSTNAME": "localhost"}
    return port, os.environ | uri | {"ROS_HOME": folder, "ROS_LOG_DIR": f"{folder}/log", "PWD": folder}


def busy_s(pid: int) -> float:
    """Return the processor time that a process has used, in the system and outside [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
