"""Starts a node's script; its module is imported here, so that it can be interrupted from the beginning."""

import importlib
import os


def start(node: str, function: str = "main") -> None:
    """Call a function of a node's module in the shell of the sourced version of ROS.

    The script has SIGINT end the process until then.
    """
    # NumPy would start a thread per core, which waits busily: more than 0.1 s of processor time for each of many nodes.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Debian's ROS 1 does not set it.
    shell = "robotteamsim.ros2" if os.environ.get("ROS_VERSION") == "2" else "robotteamsim.ros.nodes"
    getattr(importlib.import_module(f"{shell}.{node}"), function)()
