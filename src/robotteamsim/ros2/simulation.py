"""The node `simulation` of ROS 2."""

import importlib.util
import os
import tempfile
from contextlib import AbstractContextManager
from pathlib import Path

from filelock import FileLock, Timeout
from rclpy.utilities import get_default_context

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
    with _alone():
        simulation = SteppedSimulation(node, settings, Ros2TeamOutputs)
        if importlib.util.find_spec("simulation_interfaces"):
            from robotteamsim.ros2 import simulation_interfaces

            simulation_interfaces.offer(node, simulation)
        node.spin()
        simulation.serve()


def _alone() -> AbstractContextManager[object]:
    """Lock this domain for the simulations of this machine, whose topics would mix. Raises: ParameterError."""
    domain = get_default_context().get_domain_id()
    path = Path(tempfile.gettempdir(), f"robotteamsim-{os.getuid()}-domain-{domain}.lock")
    try:
        return FileLock(path, timeout=0).acquire()
    except Timeout:
        raise ParameterError(
            f"ROS_DOMAIN_ID: {domain}; another simulation runs in it; expected another domain"
        ) from None


if __name__ == "__main__":
    main()
