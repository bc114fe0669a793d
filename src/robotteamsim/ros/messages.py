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
from genpy import Time

import robotteamsim.msg

_PACKAGES = (std_msgs, geometry_msgs, nav_msgs, sensor_msgs, tf2_msgs, rosgraph_msgs, robotteamsim)


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

    def message_class(self, type_name: str) -> Any:
        """Return the class of a type such as "nav_msgs/Odometry"."""
        package_name, class_name = type_name.split("/")
        package = next(package for package in _PACKAGES if package.__name__ == package_name)
        return self._classes.setdefault(type_name, getattr(package.msg, class_name))
