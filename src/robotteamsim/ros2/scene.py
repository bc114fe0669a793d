"""The node `scene` of ROS 2: draws markers for rviz."""

from robotteamsim.nodes.scene.scene import serve
from robotteamsim.ros2.node import run


def main() -> None:
    """Run the node."""
    run("scene", serve)


if __name__ == "__main__":
    main()
