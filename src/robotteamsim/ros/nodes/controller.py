"""The nodes `controller` and `controllers` of ROS 1: drive one robot or the whole team, simulated or real."""

from robotteamsim.nodes.controller import serve_robot, serve_team
from robotteamsim.ros.node import run
from robotteamsim.ros.ros1 import Ros1Node


def main() -> None:
    """Run the node of one robot, `~robot_id`."""
    run("controller", lambda: serve_robot(Ros1Node()))


def main_of_team() -> None:
    """Run the node of all robots."""
    run("controllers", lambda: serve_team(Ros1Node()))
