"""The node `teleop` of ROS 2: drives one robot with the keyboard."""

from robotteamsim.nodes.teleop import serve
from robotteamsim.ros2.node import run


def main() -> None:
    """Run the node."""
    run("teleop", serve)


if __name__ == "__main__":
    main()
