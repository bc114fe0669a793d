"""Becomes `rosbag record` with the topics of a run. They are listed, because rosbag takes seconds to discover them."""

import os

import roslib.packages

from robotteamsim.message_parts import robot_name
from robotteamsim.recording.topics import ROBOT_TOPICS, TEAM_TOPICS
from robotteamsim.ros.node import parameter, run
from robotteamsim.ros.settings import read_settings


def main() -> None:
    """Run the node; the process then is rosbag."""
    commands: list[list[str]] = []
    run("recorder", lambda: commands.append(_command()))
    for command in commands:
        os.execv(command[0], command)


def _command() -> list[str]:
    settings = read_settings()
    topics = ["/tf_static", *(topic.name for topic in TEAM_TOPICS)]
    for robot_id in range(settings.num_robots):
        topics += [f"/{robot_name(robot_id)}/{topic.name}" for topic in ROBOT_TOPICS if topic.in_bags]
    program = roslib.packages.find_node("rosbag", "record")[0]
    bag = parameter("~bag", "mission.bag")
    return [program, "--tcpnodelay", "--buffsize", "0", "--output-name", bag, *topics, "__name:=recorder"]
