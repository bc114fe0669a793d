"""A node that publishes messages with wrong numbers on the topics of a mission, until it is ended."""

from __future__ import annotations

import itertools
import math

import rospy
from nav_msgs.msg import Odometry
from robotteamsim.msg import (
    Doors,
    MissionStatus,
    NetworkLinks,
    NetworkMessage,
    NetworkMessages,
    Robots,
    Voice,
)

ODD = (math.inf, -math.inf, math.nan, 1e300)


def main() -> None:
    """Publish."""
    rospy.init_node("garbage")
    topics = {
        "/robot_0/base_pose_ground_truth": Odometry,
        "/robot_1/odom": Odometry,
        "/robot_0/voice": Voice,
        "/robot_1/network/tx": NetworkMessages,
        "/robot_1/network/rx": NetworkMessages,
        "/network/links": NetworkLinks,
        "/mission/status": MissionStatus,
        "/world/robots": Robots,
        "/world/doors": Doors,
    }
    publishers = [rospy.Publisher(topic, kind, queue_size=100) for topic, kind in topics.items()]
    for odd in itertools.cycle(ODD):
        if rospy.is_shutdown():
            return
        for publisher in publishers:
            publisher.publish(message_of(publisher.data_class, odd))
        rospy.rostime.wallsleep(0.02)


def message_of(kind: type, odd: float) -> object:
    """Return a message of a type with a number that cannot be, or with another number of entries."""
    message = kind()
    if kind is Odometry:
        message.header.stamp = rospy.get_rostime()
        message.pose.pose.position.x = odd
    elif kind is Voice:
        message.header.stamp = rospy.get_rostime()
        message.local_best.y = odd
    elif kind is NetworkMessages:
        message.messages = [NetworkMessage(sender=99, receiver=-5)]
    elif kind is MissionStatus:
        message.area_center.x, message.has_area = odd, True
    elif kind is NetworkLinks:
        message.num_robots = 1000
    return message


if __name__ == "__main__":
    main()
