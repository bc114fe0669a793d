"""The nodes of ROS, for all its versions: what they need of one is a `Node`, which each shell has."""
