"""Boxes and barrels, as the world publishes them for rviz."""

from collections.abc import Sequence

from visualization_msgs.msg import Marker, MarkerArray

from robotteamsim import palette
from robotteamsim.geometry import Pose
from robotteamsim.ros.scene.shapes import colour, marker
from robotteamsim.scenario.objects import MovableObject

BOX, BARREL = colour(palette.BOX), colour(palette.BARREL)


def object_markers(objects: Sequence[MovableObject], poses: Sequence[Pose], *, replace: bool = False) -> MarkerArray:
    """Return one marker per object, with its index as id. Args: replace: first delete all other markers."""
    markers = [_marker(i, obj, pose) for i, (obj, pose) in enumerate(zip(objects, poses, strict=True))]
    return MarkerArray([Marker(action=Marker.DELETEALL), *markers] if replace else markers)


def _marker(marker_id: int, obj: MovableObject, pose: Pose) -> Marker:
    kind, tint = (Marker.CUBE, BOX) if obj.size_m else (Marker.CYLINDER, BARREL)
    length_m, width_m = obj.size_m or (2.0 * obj.reach_m, 2.0 * obj.reach_m)
    at, scale = (pose.x_m, pose.y_m, 0.5 * obj.height_m), (length_m, width_m, obj.height_m)
    return marker("objects", marker_id, kind, tint, position=at, yaw_rad=pose.yaw_rad, scale=scale)
