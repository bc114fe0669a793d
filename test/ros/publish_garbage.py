"""A node that publishes messages with wrong numbers on the topics of a mission, until it is ended."""

from __future__ import annotations

import itertools
import math
from typing import Any

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
from std_msgs.msg import Header


def garbage(odd: float) -> dict[str, Any]:
    """Return a message with a number that cannot be, or with another number of entries, by topic."""
    header = Header(stamp=rospy.get_rostime())
    odometry, voice = Odometry(header=header), Voice(header=header)
    odometry.pose.pose.position.x = voice.local_best.y = odd
    status = MissionStatus(has_area=True)
    status.area_center.x = odd
    messages = NetworkMessages(messages=[NetworkMessage(sender=99, receiver=-5)])
    return {
        "/robot_0/base_pose_ground_truth": odometry,
        "/robot_1/odom": odometry,
        "/robot_0/voice": voice,
        "/robot_1/network/tx": messages,
        "/robot_1/network/rx": messages,
        "/network/links": NetworkLinks(num_robots=1000),
        "/mission/status": status,
        "/world/robots": Robots(),
        "/world/doors": Doors(),
    }


def main() -> None:
    """Publish."""
    rospy.init_node("garbage")
    publishers = {topic: rospy.Publisher(topic, type(one), queue_size=100) for topic, one in garbage(0.0).items()}
    for odd in itertools.cycle((math.inf, -math.inf, math.nan, 1e300)):
        if rospy.is_shutdown():
            return
        for topic, message in garbage(odd).items():
            publishers[topic].publish(message)
        rospy.rostime.wallsleep(0.02)


if __name__ == "__main__":
    main()
