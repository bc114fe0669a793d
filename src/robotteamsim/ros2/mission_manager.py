"""The node `mission_manager` of ROS 2."""

from robotteamsim.nodes.mission_manager import MissionManager
from robotteamsim.nodes.settings import read_settings
from robotteamsim.ros2.node import run


def main() -> None:
    """Run the node."""
    run("mission_manager", lambda node: MissionManager(node, read_settings(node)).serve())


if __name__ == "__main__":
    main()
