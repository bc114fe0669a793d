"""The node `mission_manager` of ROS 1."""

import logging

import rospy

from robotteamsim.nodes.launched import ros1_setting_name
from robotteamsim.nodes.mission_manager import MissionManager
from robotteamsim.nodes.settings import read_settings
from robotteamsim.ros.node import run, wait_for_shutdown
from robotteamsim.ros.ros1 import Ros1Node

CHECK_S = 0.5
"""Interval of checks whether a simulation has been launched [s, wall]."""


def main() -> None:
    """Run the node."""
    run("mission_manager", _serve)


def _serve() -> None:
    name = ros1_setting_name("scenario")
    if not rospy.has_param(name):
        logging.getLogger(__name__).info("waiting for a simulation, which sets %s", name)
    while not rospy.has_param(name):
        if wait_for_shutdown(CHECK_S):
            return
    node = Ros1Node()
    MissionManager(node, read_settings(node)).serve()
