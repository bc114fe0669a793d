"""Parts of ROS messages that all conversions share: headers, points, names of robots and frames.

A message is a dict of its attributes by their names in ROS 2. Those that it lacks are 0, empty or False, as in ROS;
times and durations are whole numbers [ns]. `recording.encoding` makes it the bytes of a version of ROS.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

MAP_FRAME, BUILDING_FRAME = "map", "building"
_OTHERS = re.compile(rf"{MAP_FRAME}|{BUILDING_FRAME}|robot_\d+|[^A-Za-z].*|")
"""Names that no level can have as its frame and namespace: those of others, and without a letter in front."""

RosMessage = dict[str, Any]


def robot_name(robot_id: int) -> str:
    """Return the namespace and frame prefix of a robot: robot_0."""
    return f"robot_{robot_id}"


def robot_frame(robot_id: int, frame: str) -> str:
    """Return the tf2 name of a robot's frame: robot_0/base_link."""
    return f"robot_{robot_id}/{frame}"


def level_frames(names: Sequence[str]) -> list[str]:
    """Return the frame of each level, which is also the namespace of its map: its name as ROS allows it.

    Other characters than A-Z, a-z, 0-9 and _ become _; level_ is in front where the name is not free otherwise.
    """
    frames: list[str] = []
    for name in names:
        frame = re.sub(r"[^A-Za-z0-9_]", "_", name)
        while _OTHERS.fullmatch(frame) or frame in frames:
            frame = f"level_{frame}"
        frames.append(frame)
    return frames


def header(time_ns: int, frame: str) -> RosMessage:
    """std_msgs/Header."""
    return {"stamp": time_ns, "frame_id": frame}


def point(position_m: tuple[float, float]) -> RosMessage:
    """geometry_msgs/Point on the floor."""
    return {"x": position_m[0], "y": position_m[1]}


def stamp_ns(message: Any, latest_s: int = 2**32) -> int:
    """Return the stamp of a message that has been read [ns], 0 without a header.

    Args:   latest_s: no header of its version of ROS can hold this time [s].
    Raises: ValueError: an answer could not have the stamp.
    """
    header = getattr(message, "header", None)
    found_ns: int = header.stamp if header else 0
    if not 0 <= found_ns < (latest_s - 1) * 10**9:
        raise ValueError(f"stamp: {found_ns // 10**9} s; expected 0 to {latest_s} s")
    return found_ns
