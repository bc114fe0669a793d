#!/usr/bin/env python3
"""The homework of the tutorial [dissertation, Appendix 2]: passes commands on to a robot, more slowly near obstacles.

Nearer than 2.0 m to an obstacle the robot drives at half the speed; nearer than 0.3 m it never drives forward. The last
command holds for 0.8 s, as in the simulator.
"""

import copy

import rospy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import LaserScan

HALF_SPEED_BELOW_M = 2.0
NO_FORWARD_BELOW_M = 0.3
HOLD_S = 0.8


def limited_speed_mps(wanted_mps, nearest_m):
    speed_mps = wanted_mps / 2.0 if nearest_m < HALF_SPEED_BELOW_M else wanted_mps
    return min(speed_mps, 0.0) if nearest_m < NO_FORWARD_BELOW_M else speed_mps


class CarefulDriver:
    def __init__(self):
        self.nearest_m = 0.0  # do not drive forward before the first scan
        self.wanted = None
        self.wanted_at = rospy.Time()
        self.commands = rospy.Publisher("cmd_vel", Twist, queue_size=1)
        rospy.Subscriber("base_scan", LaserScan, self.on_scan)
        rospy.Subscriber("wanted_vel", Twist, self.on_wanted)

    def on_scan(self, scan):
        if scan.ranges:
            self.nearest_m = min(scan.ranges)
        if self.wanted is None:
            return
        # Again, because the robot may come near an obstacle while no new command arrives.
        if 0.0 <= (rospy.Time.now() - self.wanted_at).to_sec() < HOLD_S:
            self.publish()
        else:
            self.wanted = None
            self.commands.publish(Twist())

    def on_wanted(self, command):
        self.wanted = command
        self.wanted_at = rospy.Time.now()
        self.publish()

    def publish(self):
        limited = copy.deepcopy(self.wanted)
        limited.linear.x = limited_speed_mps(self.wanted.linear.x, self.nearest_m)
        self.commands.publish(limited)


if __name__ == "__main__":
    rospy.init_node("careful_driver")
    driver = CarefulDriver()
    rospy.spin()
