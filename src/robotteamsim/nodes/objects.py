"""Boxes and barrels as markers for rviz."""

from collections.abc import Sequence
from typing import Any

from robotteamsim import palette
from robotteamsim.geometry import Pose, PoseReading
from robotteamsim.message_parts import MAP_FRAME, Make, header
from robotteamsim.recording.topics.base import pose
from robotteamsim.scenario.objects import MovableObject

CUBE, CYLINDER, ADD, DELETE_ALL = 1, 3, 0, 3
"""Constants of visualization_msgs/Marker."""


def object_markers(
    make: Make, objects: Sequence[MovableObject], poses: Sequence[Pose], *, replace: bool = False
) -> Any:
    """visualization_msgs/MarkerArray: one marker per object, with its index as id.

    Args: replace: first delete all other markers.
    """
    markers = [_marker(make, i, obj, at) for i, (obj, at) in enumerate(zip(objects, poses, strict=True))]
    clearing = [_shape(make, 0, DELETE_ALL, 0, palette.BOX, Pose(0.0, 0.0, 0.0), (1.0, 1.0, 1.0))] if replace else []
    return make("visualization_msgs/MarkerArray", markers=[*clearing, *markers])


def _marker(make: Make, marker_id: int, obj: MovableObject, at: Pose) -> Any:
    kind, colour = (CUBE, palette.BOX) if obj.size_m else (CYLINDER, palette.BARREL)
    length_m, width_m = obj.size_m or (2.0 * obj.reach_m, 2.0 * obj.reach_m)
    return _shape(make, marker_id, ADD, kind, colour, at, (length_m, width_m, obj.height_m))


def _shape(
    make: Make, marker_id: int, action: int, kind: int, colour: str, at: Pose, size_m: tuple[float, float, float]
) -> Any:
    """Return a marker that stands on the floor. Its stamp is 0, "at any time": rviz then needs no current transform."""
    red, green, blue = palette.rgb(colour)
    place = pose(make, PoseReading.from_pose(at))
    place.position.z = 0.5 * size_m[2]
    return make(
        "visualization_msgs/Marker",
        header=header(make, 0, MAP_FRAME),
        ns="objects",
        id=marker_id,
        type=kind,
        action=action,
        pose=place,
        scale=make("geometry_msgs/Vector3", x=size_m[0], y=size_m[1], z=size_m[2]),
        color=make("std_msgs/ColorRGBA", r=red, g=green, b=blue, a=1.0),
        lifetime=make.duration(0),
        frame_locked=False,
        points=[],
        colors=[],
        text="",
        mesh_resource="",
        mesh_use_embedded_materials=False,
    )
