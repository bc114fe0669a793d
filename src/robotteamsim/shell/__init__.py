"""What the shells of ROS share: parts of nodes that need no ROS."""
