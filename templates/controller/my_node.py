#!/usr/bin/env python3
"""A controller as a ROS node: drive forward, turn away from obstacles. It does not depend on robotteamsim."""

import rospy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import LaserScan

NEAR_M = 0.6


def drive(scan):
    third = len(scan.ranges) // 3
    command = Twist()
    if min(scan.ranges[third:-third]) < NEAR_M:  # middle of the scan
        command.angular.z = 1.0
    else:
        command.linear.x = 0.4
    commands.publish(command)


rospy.init_node("my_node")
commands = rospy.Publisher("cmd_vel", Twist, queue_size=1)
rospy.Subscriber("base_scan", LaserScan, drive)
rospy.spin()
