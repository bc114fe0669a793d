#!/usr/bin/env python3
"""Drives one robot of Gazebo against a closed door, opens the door, and writes the findings to a file."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import rosgraph
import rospy
from geometry_msgs.msg import Twist
from listening import Topic, call, speed_mps
from nav_msgs.msg import Odometry
from robotteamsim.msg import Contact, Doors
from robotteamsim.srv import SetDoor
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage

DOOR = "stair_door"
SPEED_MPS = 0.5


def command(forward_mps: float, turn_radps: float = 0.0) -> Twist:
    twist = Twist()
    twist.linear.x, twist.angular.z = forward_mps, turn_radps
    return twist


class Robot:
    """The topics of robot 0."""

    def __init__(self) -> None:
        self.truth = Topic("/robot_0/base_pose_ground_truth", Odometry)
        self.odometry = Topic("/robot_0/odom", Odometry)
        self.scan = Topic("/robot_0/base_scan", LaserScan)
        self.contact = Topic("/robot_0/contact", Contact)
        self._output = rospy.Publisher("/robot_0/cmd_vel", Twist, queue_size=10, tcp_nodelay=True)
        while not self._is_heard_by_gazebo():
            rospy.rostime.wallsleep(0.05)
        self.truth.next()

    def _is_heard_by_gazebo(self) -> bool:
        """Whether all subscribers are connected, Gazebo among them; the simulation subscribes, too, and is sooner."""
        _, subscribers, _ = rosgraph.Master(rospy.get_name()).getSystemState()
        nodes = dict(subscribers).get(self._output.resolved_name, [])
        return "/gazebo" in nodes and self._output.get_num_connections() >= len(nodes)

    def send(self, twist: Twist, steps: int) -> list[Odometry]:
        """Send a command once and return the ground truth of the next steps."""
        begin = len(self.truth.messages)
        self._output.publish(twist)
        return list(self.truth.wait_for_count(begin + steps)[begin:])

    def ahead_m(self) -> float:
        """Return the range of the middle beam in a scan yet to come."""
        ranges = self.scan.next().ranges
        return ranges[len(ranges) // 2]


def main() -> None:
    rospy.init_node("drive_to_door", disable_rostime=True)
    robot, doors, frames = Robot(), Topic("/world/doors", Doors), Topic("/tf", TFMessage)
    found: dict[str, Any] = {"ahead_closed_m": robot.ahead_m()}
    begin = robot.truth.messages[-1].pose.pose.position
    once = robot.send(command(SPEED_MPS), 20)
    found["moving_steps"] = sum(speed_mps(message) > 0.5 * SPEED_MPS for message in once)
    found["distance_m"] = once[-1].pose.pose.position.x - begin.x
    found["odometry_m"] = robot.odometry.wait_for_count(len(robot.truth.messages))[-1].pose.pose.position.x
    found["after_nan"] = speed_mps(robot.send(command(float("nan")), 5)[-1])
    turned = robot.send(command(0.0, 0.5), 15)
    found["turned_rad"] = 2.0 * turned[-1].pose.pose.orientation.z
    robot.send(command(0.0, -0.5), 15)
    while not robot.contact.messages[-1].in_contact and robot.truth.messages[-1].pose.pose.position.x < 56.0:
        robot.send(command(SPEED_MPS), 5)
    found["contact_angles_rad"] = robot.contact.messages[-1].angles_rad
    found["stopped_at_m"] = robot.send(command(SPEED_MPS), 5)[-1].pose.pose.position.x
    robot.send(command(-SPEED_MPS), 15)
    unknown = call("/world/set_door", SetDoor, name="no_such_door", closed=True)
    found["refusal"] = [unknown.success, unknown.message]
    found["closed_before"] = {door.name: door.closed for door in doors.next().doors}
    found["accepted"] = call("/world/set_door", SetDoor, name=DOOR, closed=False).success
    doors.wait_for(lambda message: not any(door.closed for door in message.doors if door.name == DOOR), "an open door")
    found["ahead_open_m"] = robot.ahead_m()
    found["frames"] = sorted({link.child_frame_id for message in frames.messages for link in message.transforms})
    Path(sys.argv[1]).write_text(json.dumps(found))


main()
