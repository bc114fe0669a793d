"""The node `simulation` of ROS 1."""

from robotteamsim.nodes.settings import read_settings
from robotteamsim.nodes.simulation import SteppedSimulation
from robotteamsim.ros.node import run
from robotteamsim.ros.ros1 import Ros1Node
from robotteamsim.ros.topics import RoscppOutput


def main() -> None:
    """Run the node."""
    run("simulation", _serve)


def _serve() -> None:
    node = Ros1Node(RoscppOutput)
    SteppedSimulation(node, read_settings(node, report_s=0.0)).serve()
