"""Teams of mobile robots in search and rescue: the same mission headless and in ROS 1."""

__version__ = "0.1.0"
