"""Becomes `rosbag record` with the topics of a run."""

import os

import roslib.packages

from robotteamsim.nodes.recorded import recorded_topics
from robotteamsim.nodes.settings import read_settings
from robotteamsim.ros.node import parameter, run
from robotteamsim.ros.ros1 import Ros1Node
from robotteamsim.ros.subscriptions import RECORDER


def main() -> None:
    """Run the node; the process then is rosbag."""
    commands: list[list[str]] = []
    run(RECORDER, lambda: commands.append(_command()))
    for command in commands:
        os.execv(command[0], command)


def _command() -> list[str]:
    topics = recorded_topics(read_settings(Ros1Node()))
    program = roslib.packages.find_node("rosbag", "record")[0]
    bag = parameter("~bag", "mission.bag")
    return [program, "--tcpnodelay", "--buffsize", "0", "--output-name", bag, *topics, f"__name:={RECORDER}"]
