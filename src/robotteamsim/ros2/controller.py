"""The node `controller` of ROS 2: drives one robot."""

from robotteamsim.nodes.controller import serve_robot
from robotteamsim.ros2.node import run


def main() -> None:
    """Run the node of one robot, parameter `robot_id`."""
    run("controller", serve_robot)


if __name__ == "__main__":
    main()
