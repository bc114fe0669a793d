"""The nodes of ROS 2, on rclpy."""
