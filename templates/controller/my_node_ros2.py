#!/usr/bin/env python3
"""A controller as a ROS 2 node: drive forward, turn away from obstacles. It does not depend on robotteamsim."""

import contextlib

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import LaserScan

NEAR_M = 0.6


class MyNode(Node):
    def __init__(self):
        super().__init__("my_node")
        self.commands = self.create_publisher(Twist, "cmd_vel", 1)
        self.create_subscription(LaserScan, "base_scan", self.drive, 1)

    def drive(self, scan):
        third = len(scan.ranges) // 3
        command = Twist()
        if min(scan.ranges[third:-third]) < NEAR_M:  # middle of the scan
            command.angular.z = 1.0
        else:
            command.linear.x = 0.4
        self.commands.publish(command)


rclpy.init()
with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
    rclpy.spin(MyNode())
