"""Makes messages of ROS's classes."""

from __future__ import annotations

from typing import Any

import geometry_msgs.msg
import nav_msgs.msg
import numpy as np
import rosgraph_msgs.msg
import sensor_msgs.msg
import std_msgs.msg
import tf2_msgs.msg
import visualization_msgs.msg
from genpy import Duration, Time

import robotteamsim.msg

_PACKAGES = (std_msgs, geometry_msgs, nav_msgs, sensor_msgs, tf2_msgs, rosgraph_msgs, visualization_msgs, robotteamsim)

_LATEST_S = 2**32
"""A header has 32 bits for the seconds."""


class RosTypes:
    """Builds messages of ROS's classes; the `make` of `recording.topics`."""

    def __init__(self) -> None:
        self._classes: dict[str, Any] = {}

    def __call__(self, type_name: str, /, **attributes: Any) -> Any:
        """Return a message of a type such as "nav_msgs/Odometry". Every attribute must be given."""
        message_class = self._classes.get(type_name) or self.message_class(type_name)
        # All attributes are given, so the defaults that __init__ would fill in first are not needed.
        message = message_class.__new__(message_class)
        for name, value in attributes.items():
            if type(value) is np.ndarray:  # uint8[] is bytes in genpy; other arrays are serialized fastest from lists.
                value = value.tobytes() if value.dtype == np.uint8 else value.tolist()
            setattr(message, name, value)
        return message

    def time(self, time_ns: int) -> Time:
        """Return the stamp of a time [ns]."""
        return Time(*divmod(time_ns, 10**9))

    def duration(self, duration_ns: int) -> Duration:
        """Return a duration [ns]."""
        return Duration(*divmod(duration_ns, 10**9))

    def message_class(self, type_name: str) -> Any:
        """Return the class of a type such as "nav_msgs/Odometry"."""
        package_name, class_name = type_name.split("/")
        package = next(package for package in _PACKAGES if package.__name__ == package_name)
        return self._classes.setdefault(type_name, getattr(package.msg, class_name))


def stamp_ns(message: Any) -> int:
    """Return the stamp of a message [ns], 0 without a header. Raises: ValueError: an answer could not have it."""
    if not hasattr(message, "header"):
        return 0
    stamp = message.header.stamp
    if stamp.secs + 1 >= _LATEST_S:
        raise ValueError(f"stamp: {stamp.secs} s; expected below 2^32 s")
    return int(stamp.secs * 10**9 + stamp.nsecs)
