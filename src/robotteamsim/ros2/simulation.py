"""The node `simulation` of ROS 2."""

import importlib.util

from rclpy.utilities import get_default_context

from robotteamsim.nodes.launched import lock_domain
from robotteamsim.nodes.settings import read_settings
from robotteamsim.nodes.simulation import SteppedSimulation
from robotteamsim.ros2.node import Ros2Node, run
from robotteamsim.ros2.team_outputs import Ros2TeamOutputs


def main() -> None:
    """Run the node."""
    run("simulation", _serve, owns_settings=True)


def _serve(node: Ros2Node) -> None:
    settings = read_settings(node, report_s=0.0)
    with lock_domain(get_default_context().get_domain_id()):
        simulation = SteppedSimulation(node, settings, Ros2TeamOutputs)
        if importlib.util.find_spec("simulation_interfaces"):
            from robotteamsim.ros2 import simulation_interfaces

            simulation_interfaces.offer(node, simulation)
        node.spin()
        node.warn_of_unknown_parameters()
        simulation.serve()


if __name__ == "__main__":
    main()
