"""The node `scene` of ROS 1."""

from functools import partial

from robotteamsim.nodes.scene.scene import serve
from robotteamsim.ros.node import run
from robotteamsim.ros.ros1 import Ros1Node
from robotteamsim.ros.topics import RospyOutput


def main() -> None:
    """Run the node; a slow rviz gets the newest markers."""
    run("scene", lambda: serve(Ros1Node(partial(RospyOutput, queue_size=1))))
