#!/usr/bin/env python3
"""The homework of the tutorial [dissertation, Appendix 2]: passes commands on to a robot, more slowly near obstacles.

Nearer than 2.0 m to an obstacle the robot drives at half the speed; nearer than 0.3 m it never drives forward.
"""

import rospy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import LaserScan

HALF_SPEED_BELOW_M = 2.0
NO_FORWARD_BELOW_M = 0.3


def limited_speed_mps(wanted_mps, nearest_m):
    speed_mps = wanted_mps / 2.0 if nearest_m < HALF_SPEED_BELOW_M else wanted_mps
    return min(speed_mps, 0.0) if nearest_m < NO_FORWARD_BELOW_M else speed_mps


class CarefulDriver:
    def __init__(self):
        self.nearest_m = 0.0  # do not drive forward before the first scan
        self.commands = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        rospy.Subscriber("base_scan", LaserScan, self.on_scan)
        rospy.Subscriber("wanted_vel", Twist, self.on_wanted)

    def on_scan(self, scan):
        if scan.ranges:
            self.nearest_m = min(scan.ranges)

    def on_wanted(self, command):
        command.linear.x = limited_speed_mps(command.linear.x, self.nearest_m)
        self.commands.publish(command)


if __name__ == "__main__":
    rospy.init_node("careful_driver")
    driver = CarefulDriver()
    rospy.spin()
