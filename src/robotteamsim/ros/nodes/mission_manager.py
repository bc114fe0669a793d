"""The node `mission_manager` of ROS 1."""

from robotteamsim.nodes.mission_manager import MissionManager
from robotteamsim.nodes.settings import read_settings
from robotteamsim.ros.node import run
from robotteamsim.ros.ros1 import Ros1Node


def main() -> None:
    """Run the node."""
    run("mission_manager", _serve)


def _serve() -> None:
    node = Ros1Node()
    MissionManager(node, read_settings(node)).serve()
