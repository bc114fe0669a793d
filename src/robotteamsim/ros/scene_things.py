"""Boxes and barrels in the 3D scene."""

from __future__ import annotations

from collections.abc import Sequence

from visualization_msgs.msg import Marker, MarkerArray

from robotteamsim.geometry import Pose
from robotteamsim.ros.scene_shapes import colour, marker
from robotteamsim.scenario.things import Thing

BOX = colour("#a9793f")
BARREL = colour("#3f6f8f")


def thing_markers(things: Sequence[Thing], poses: Sequence[Pose]) -> MarkerArray:
    """Return one cuboid or cylinder per thing, with its place in the list as id."""
    return MarkerArray([_marker(i, thing, pose) for i, (thing, pose) in enumerate(zip(things, poses, strict=True))])


def _marker(marker_id: int, thing: Thing, pose: Pose) -> Marker:
    size_m = thing.size_m or (2.0 * thing.reach_m, 2.0 * thing.reach_m)
    is_box = thing.kind == "box"
    return marker(
        "things",
        marker_id,
        Marker.CUBE if is_box else Marker.CYLINDER,
        BOX if is_box else BARREL,
        position=(pose.x_m, pose.y_m, 0.5 * thing.height_m),
        yaw_rad=pose.yaw_rad,
        scale=(*size_m, thing.height_m),
    )
