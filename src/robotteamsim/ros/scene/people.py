"""People in the 3D scene, lying or upright: firefighters and victims."""

from visualization_msgs.msg import Marker

from robotteamsim import palette
from robotteamsim.geometry import Pose
from robotteamsim.ros.scene.shapes import Colour, colour, marker

SKIN, HELMET, COAT = colour(palette.SKIN), colour(palette.HELMET), colour(palette.TURNOUT_COAT)

# Parts of a figure: whether it is dressed, place along and across the body and above the floor, and size [m].
_LYING = (
    (False, 0.72, 0.0, 0.13, (0.26, 0.24, 0.26)),
    (True, 0.22, 0.0, 0.15, (0.85, 0.52, 0.3)),
    (True, 0.28, 0.36, 0.08, (0.62, 0.13, 0.13)),
    (True, 0.28, -0.36, 0.08, (0.62, 0.13, 0.13)),
    (True, -0.5, 0.13, 0.1, (0.95, 0.18, 0.18)),
    (True, -0.5, -0.13, 0.1, (0.95, 0.18, 0.18)),
)
# Larger than life: from above, one sees little of them.
_UPRIGHT = (
    (False, 0.0, 0.0, 2.4, (0.6, 0.6, 0.55)),
    (True, 0.0, 0.0, 1.55, (0.5, 0.85, 1.3)),
    (True, 0.0, 0.2, 0.55, (0.3, 0.3, 1.1)),
    (True, 0.0, -0.2, 0.55, (0.3, 0.3, 1.1)),
)


def figure(
    namespace: str, number: int, pose: Pose, clothes: Colour, *, head: Colour = SKIN, lies: bool, raised_m: float = 0.0
) -> list[Marker]:
    """Return a person. Args: number: of the person.  raised_m: height above the floor of one who is carried."""
    found = []
    parts = _LYING if lies else _UPRIGHT
    for i, (dressed, along_m, across_m, z_m, size_m) in enumerate(parts):
        at = pose @ Pose(along_m, across_m, 0.0)
        position, marker_id = (at.x_m, at.y_m, z_m + raised_m), len(_LYING) * number + i
        tint = clothes if dressed else head
        found.append(
            marker(namespace, marker_id, Marker.SPHERE, tint, position=position, yaw_rad=pose.yaw_rad, scale=size_m)
        )
    return found
