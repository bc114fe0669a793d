"""The node `simulation` of ROS 2."""

from robotteamsim.nodes.node import ParameterError
from robotteamsim.nodes.settings import read_settings
from robotteamsim.nodes.simulation import SteppedSimulation
from robotteamsim.ros2.node import Ros2Node, run
from robotteamsim.ros2.team_outputs import Ros2TeamOutputs


def main() -> None:
    """Run the node."""
    run("simulation", _serve, owns_settings=True)


def _serve(node: Ros2Node) -> None:
    settings = read_settings(node, report_s=0.0)
    if settings.elsewhere:
        raise ParameterError("elsewhere: robots in another world are not available in ROS 2; expected none")
    if settings.by_tf:
        node.transforms()
    simulation = SteppedSimulation(node, settings, Ros2TeamOutputs)
    node.spin()
    simulation.serve()


if __name__ == "__main__":
    main()
