"""Parts of ROS messages that all conversions share: headers, points, names of robots and frames.

A message is a dict of its attributes by their names in ROS 2. Those that it lacks are 0, empty or False, as in ROS;
times and durations are whole numbers [ns]. `recording.encoding` makes it the bytes of a version of ROS.
"""

from __future__ import annotations

from typing import Any

MAP_FRAME = "map"

RosMessage = dict[str, Any]


def robot_name(robot_id: int) -> str:
    """Return the namespace and frame prefix of a robot: robot_0."""
    return f"robot_{robot_id}"


def robot_frame(robot_id: int, frame: str) -> str:
    """Return the tf2 name of a robot's frame: robot_0/base_link."""
    return f"robot_{robot_id}/{frame}"


def header(time_ns: int, frame: str) -> RosMessage:
    """std_msgs/Header."""
    return {"stamp": time_ns, "frame_id": frame}


def point(position_m: tuple[float, float]) -> RosMessage:
    """geometry_msgs/Point on the floor."""
    return {"x": position_m[0], "y": position_m[1]}


def time_ns(stamp: Any) -> int:
    """Return the time of a stamp of genpy, rosbags or rclpy [ns]."""
    if hasattr(stamp, "secs"):
        return int(stamp.secs * 10**9 + stamp.nsecs)
    return int(stamp.sec * 10**9 + stamp.nanosec)
