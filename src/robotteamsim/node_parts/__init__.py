"""Parts of the nodes of ROS that need no ROS."""
