"""Boxes and barrels in the 3D scene."""

import functools
import itertools
import math
from collections.abc import Sequence

import shapely
from visualization_msgs.msg import Marker, MarkerArray

from robotteamsim import palette
from robotteamsim.geometry import Pose
from robotteamsim.ros.scene import view
from robotteamsim.ros.scene.plan import SHADOW_Z_M
from robotteamsim.ros.scene.shapes import WHITE, Mesh, circle_points, colour, marker, shaded
from robotteamsim.scenario.objects import MovableObject

BOX, TAPE = colour(palette.BOX), colour(palette.TAPE)
BARREL, HOOP = colour(palette.BARREL), colour(palette.HOOP)
GROUND = colour(palette.SHADOW)
GROUND_M = 0.035
"""Width of the dark ground around an object, which connects the object with the floor visually."""

TAPE_SHARE = 0.09
"""Half the width of the tape across a box, as a share of its width."""
BARREL_SIDES = 20
HOOP_SHARES = (0.04, 0.33, 0.67, 0.96)
"""Heights of the hoops of a barrel."""
HOOP_HALF_SHARE = 0.035
RIM_M = 0.012
"""How far hoops, rims and tapes protrude."""
FACE_LIGHTS = (0.62, 0.72, 0.84, 0.66)
"""Brightness of a box's sides. It turns with the box, because rviz does not light triangles with colours."""


def object_markers(objects: Sequence[MovableObject], poses: Sequence[Pose], *, replace: bool = False) -> MarkerArray:
    """Return one marker per object, with its index as id. Args: replace: first delete all other markers."""
    markers = [_marker(i, obj, pose) for i, (obj, pose) in enumerate(zip(objects, poses, strict=True))]
    return MarkerArray([Marker(action=Marker.DELETEALL), *markers] if replace else markers)


def covered(markers: Sequence[Marker], eye_m: tuple[float, float, float]) -> shapely.Geometry:
    """Return the part of the floor that objects cover in the default view. Args: markers: of `object_markers`."""
    drawn = [marker for marker in markers if marker.points]
    discs = []
    for each in drawn:
        reach_m = max(math.hypot(point.x, point.y) for point in each.points)
        disc = shapely.Point(each.pose.position.x, each.pose.position.y).buffer(reach_m, 4)
        discs.append(view.covered(eye_m, disc, max(point.z for point in each.points)))
    return shapely.union_all(discs)


def _marker(marker_id: int, obj: MovableObject, pose: Pose) -> Marker:
    at = (pose.x_m, pose.y_m, 0.0)
    result = marker("objects", marker_id, Marker.TRIANGLE_LIST, WHITE, position=at, yaw_rad=pose.yaw_rad)
    drawn = _drawn(obj.size_m, obj.reach_m, obj.height_m)
    result.points, result.colors = drawn.points, drawn.colors
    return result


@functools.lru_cache(maxsize=256)
def _drawn(size_m: tuple[float, float] | None, radius_m: float, height_m: float) -> Marker:
    """Return the triangles of an object around its centre; cached, because each step publishes them."""
    shape = _barrel(radius_m, height_m) if size_m is None else _box(*size_m, height_m)
    return shape.marker("objects", 0)


def _box(length_m: float, width_m: float, height_m: float) -> Mesh:
    """Return a box with a tape along its middle, on a dark patch of ground."""
    x, y, tape = 0.5 * length_m, 0.5 * width_m, TAPE_SHARE * width_m
    mesh = Mesh()
    mesh.quad([(a * (x + GROUND_M), b * (y + GROUND_M), SHADOW_Z_M) for a, b in _SIGNS], [GROUND] * 4)
    corners = [(a * x, b * y) for a, b in _SIGNS]
    mesh.quad([(*corner, height_m) for corner in corners], [BOX] * 4)
    for (x0, y0), (x1, y1), light in zip(corners, [*corners[1:], corners[0]], FACE_LIGHTS, strict=True):
        high, low = shaded(BOX, light), shaded(BOX, 0.6 * light)
        mesh.quad([(x0, y0, 0.0), (x1, y1, 0.0), (x1, y1, height_m), (x0, y0, height_m)], [low, low, high, high])
    mesh.quad([(a * x, b * tape, height_m + RIM_M) for a, b in _SIGNS], [TAPE] * 4)
    return mesh


def _barrel(radius_m: float, height_m: float) -> Mesh:
    """Return a barrel with hoops and a recessed lid, on a dark patch of ground."""
    mesh = Mesh()
    mesh.ring((0.0, 0.0), 0.0, radius_m + GROUND_M, SHADOW_Z_M, GROUND)
    _wall(mesh, radius_m, 0.0, height_m, BARREL)
    for share in HOOP_SHARES:
        middle_m, half_m = share * height_m, HOOP_HALF_SHARE * height_m
        _wall(mesh, radius_m + RIM_M, middle_m - half_m, middle_m + half_m, HOOP)
    mesh.ring((0.0, 0.0), 0.0, radius_m, height_m, shaded(BARREL, 0.85))
    mesh.ring((0.0, 0.0), 0.85 * radius_m, radius_m + RIM_M, height_m + RIM_M, HOOP)
    mesh.ring((0.45 * radius_m, 0.0), 0.0, 0.16 * radius_m, height_m + RIM_M, shaded(HOOP, 0.6))
    return mesh


def _wall(mesh: Mesh, radius_m: float, low_m: float, high_m: float, tint: tuple[float, float, float, float]) -> None:
    """Add an upright wall around the origin, lighter on one side."""
    rim = circle_points(radius_m, BARREL_SIDES, closed=True)
    for (x0, y0), (x1, y1) in itertools.pairwise(rim):
        side = shaded(tint, 0.72 - 0.2 * (x0 - y0) / (1.42 * radius_m))
        mesh.quad([(x0, y0, low_m), (x1, y1, low_m), (x1, y1, high_m), (x0, y0, high_m)], [side] * 4)


_SIGNS = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
"""The corners of a rectangle, counter-clockwise."""
