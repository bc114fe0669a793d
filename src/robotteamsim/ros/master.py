"""Waiting for the ROS master, before rospy is imported."""

import sys
import time
from collections.abc import Callable

import rosgraph

MASTER_PERIOD_S = 0.2
"""Interval of checks whether the master has started [s, wall]."""


def wait_for_master(wait: Callable[[float], object] = time.sleep) -> None:
    """Wait until the master is online. Args: wait: waits for a time [s, wall]; returns true to give up."""
    if rosgraph.is_master_online():
        return
    sys.stderr.write(f"waiting for the ROS master at {rosgraph.get_master_uri()}\n")
    while not wait(MASTER_PERIOD_S) and not rosgraph.is_master_online():
        pass
