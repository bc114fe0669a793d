"""The node `teleop` of ROS 1."""

from robotteamsim.nodes.teleop import serve
from robotteamsim.ros.node import run
from robotteamsim.ros.ros1 import Ros1Node


def main() -> None:
    """Run the node."""
    run("teleop", lambda: serve(Ros1Node()))
