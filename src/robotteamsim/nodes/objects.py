"""Boxes and barrels as markers for rviz."""

from collections.abc import Sequence
from typing import Any

from robotteamsim import palette
from robotteamsim.geometry import Pose
from robotteamsim.message_parts import Make
from robotteamsim.nodes.markers import CUBE, CYLINDER, DELETE_ALL, Marker, array_message
from robotteamsim.scenario.objects import MovableObject

_NAMESPACE = "objects"


def object_markers(
    make: Make, objects: Sequence[MovableObject], poses: Sequence[Pose], *, replace: bool = False
) -> Any:
    """visualization_msgs/MarkerArray: one marker per object, with its index as id.

    Args: replace: first delete all other markers.
    """
    markers = [_marker(i, obj, at) for i, (obj, at) in enumerate(zip(objects, poses, strict=True))]
    clearing = [Marker(_NAMESPACE, 0, CUBE, (1.0, 1.0, 1.0, 1.0), action=DELETE_ALL)] if replace else []
    return array_message(make, [*clearing, *markers])


def _marker(marker_id: int, obj: MovableObject, at: Pose) -> Marker:
    kind, colour = (CUBE, palette.BOX) if obj.size_m else (CYLINDER, palette.BARREL)
    length_m, width_m = obj.size_m or (2.0 * obj.reach_m, 2.0 * obj.reach_m)
    place = (at.x_m, at.y_m, 0.5 * obj.height_m)
    scale = (length_m, width_m, obj.height_m)
    return Marker(_NAMESPACE, marker_id, kind, (*palette.rgb(colour), 1.0), place, at.yaw_rad, scale)
