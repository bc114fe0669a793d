"""Markers for rviz, and their messages."""

from __future__ import annotations

from dataclasses import dataclass, field

from robotteamsim.geometry import Pose, PoseReading
from robotteamsim.message_parts import MAP_FRAME, RosMessage, header
from robotteamsim.recording.topics.base import pose

ARROW, CUBE, SPHERE, CYLINDER, LINE_STRIP, LINE_LIST, TEXT_VIEW_FACING, TRIANGLE_LIST = 0, 1, 2, 3, 4, 5, 9, 11
ADD, DELETE, DELETE_ALL = 0, 2, 3
"""Constants of visualization_msgs/Marker."""

ARRAY = "visualization_msgs/MarkerArray"

Colour = tuple[float, float, float, float]
"""Red, green, blue and opacity, each 0..1."""

Position = tuple[float, float, float]
"""x, y, z in the map frame, or in the frame of the marker's own pose [m]."""


@dataclass
class Marker:
    """A marker in the map frame. ns, id, type, action and scale are those of visualization_msgs/Marker.

    points, tints: of a list of lines or triangles: its corners, and the colour of each.
    """

    ns: str
    id: int
    type: int
    tint: Colour
    position: Position = (0.0, 0.0, 0.0)
    yaw_rad: float = 0.0
    scale: Position = (1.0, 1.0, 1.0)
    points: list[Position] = field(default_factory=list)
    tints: list[Colour] = field(default_factory=list)
    text: str = ""
    action: int = ADD


def marker_message(marker: Marker) -> RosMessage:
    """visualization_msgs/Marker.

    Its stamp is 0, "at any time", so that rviz needs no current transform, which a paused or slow world lacks.
    """
    x_m, y_m, z_m = marker.position
    place = pose(PoseReading.from_pose(Pose(x_m, y_m, marker.yaw_rad)))
    place["position"]["z"] = z_m
    length_m, width_m, height_m = marker.scale
    return {
        "header": header(0, MAP_FRAME),
        "ns": marker.ns,
        "id": marker.id,
        "type": marker.type,
        "action": marker.action,
        "pose": place,
        "scale": {"x": length_m, "y": width_m, "z": height_m},
        "color": _colour(marker.tint),
        "points": [{"x": x, "y": y, "z": z} for x, y, z in marker.points],
        "colors": [_colour(tint) for tint in marker.tints],
        "text": marker.text,
    }


def array_message(markers: list[Marker]) -> RosMessage:
    """visualization_msgs/MarkerArray."""
    return {"markers": [marker_message(marker) for marker in markers]}


def _colour(tint: Colour) -> RosMessage:
    red, green, blue, opacity = tint
    return {"r": red, "g": green, "b": blue, "a": opacity}
