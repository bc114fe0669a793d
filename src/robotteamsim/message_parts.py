"""Parts of ROS messages that all conversions share: headers, points, names of robots and frames."""

from __future__ import annotations

from typing import Any, Protocol

MAP_FRAME = "map"


class Make(Protocol):
    """Builds messages of one library: of genpy in nodes, of rosbags in bags and MCAP files.

    Numeric arrays are passed as NumPy arrays of the attribute's type; a factory converts them if its classes need
    something else.
    """

    def __call__(self, type_name: str, /, **attributes: Any) -> Any:
        """Return a message of a type such as "nav_msgs/Odometry"; every attribute is given."""

    def time(self, time_ns: int) -> Any:
        """Return the stamp of a time [ns]."""

    def duration(self, duration_ns: int) -> Any:
        """Return a duration [ns]."""


def robot_name(robot_id: int) -> str:
    """Return the namespace and frame prefix of a robot: robot_0."""
    return f"robot_{robot_id}"


def robot_frame(robot_id: int, frame: str) -> str:
    """Return the tf2 name of a robot's frame: robot_0/base_link."""
    return f"robot_{robot_id}/{frame}"


def header(make: Make, time_ns: int, frame: str) -> Any:
    """std_msgs/Header."""
    return make("std_msgs/Header", seq=0, stamp=make.time(time_ns), frame_id=frame)


def point(make: Make, position_m: tuple[float, float]) -> Any:
    """geometry_msgs/Point on the floor."""
    return make("geometry_msgs/Point", x=float(position_m[0]), y=float(position_m[1]), z=0.0)


def time_ns(stamp: Any) -> int:
    """Return the time of a stamp of genpy, rosbags or rclpy [ns]."""
    if hasattr(stamp, "secs"):
        return int(stamp.secs * 10**9 + stamp.nsecs)
    return int(stamp.sec * 10**9 + stamp.nanosec)
