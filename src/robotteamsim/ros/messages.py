"""Messages of ROS's classes."""

from __future__ import annotations

import importlib
from functools import cache
from io import BytesIO
from typing import Any


def message_class(type_name: str) -> Any:
    """Return the class of a type such as "nav_msgs/Odometry"."""
    package, name = type_name.split("/")
    return getattr(importlib.import_module(f"{package}.msg"), name)


@cache
def bytes_class(type_name: str) -> Any:
    """Return a class for messages of a type that are nothing but their bytes, as they are sent.

    One that cannot be read is reported by the node that reads it; the connection stays open.
    """

    class Bytes(message_class(type_name)):  # type: ignore[misc]
        _has_header = False  # which rospy would number

        def __init__(self, data: bytes = b"") -> None:
            """Not that of the type, which would fill in every attribute."""
            self.data = data

        def serialize(self, buffer: BytesIO) -> None:
            buffer.write(self.data)

        def deserialize(self, data: bytes) -> Any:
            self.data = data
            return self

    return Bytes
