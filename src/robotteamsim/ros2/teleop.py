"""The node `teleop` of ROS 2: drives one robot with the keyboard."""

from robotteamsim.nodes.teleop import serve
from robotteamsim.ros2.node import Ros2Node, run


def main() -> None:
    """Run the node."""
    run("teleop", _serve, owns_settings=True)  # it may drive a real robot, where there is no simulation


def _serve(node: Ros2Node) -> None:
    node.spin()
    serve(node)


if __name__ == "__main__":
    main()
