"""The node `controllers` of ROS 2: drives the whole team."""

from robotteamsim.nodes.controller import serve_team
from robotteamsim.ros2.node import run


def main() -> None:
    """Run the node of all robots."""
    run("controllers", serve_team)


if __name__ == "__main__":
    main()
