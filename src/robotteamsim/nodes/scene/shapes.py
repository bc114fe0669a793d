"""Building blocks of the 3D scene: colours, markers, people and triangle meshes."""

import itertools
import math
from collections.abc import Iterable, Sequence

import shapely
from shapely.geometry.polygon import orient

from robotteamsim import palette
from robotteamsim.geometry import Pose
from robotteamsim.recording.topics.markers import (
    LINE_LIST,
    SPHERE,
    TEXT_VIEW_FACING,
    TRIANGLE_LIST,
    Colour,
    Marker,
    Position,
)
from robotteamsim.scenario import Bounds

FITTED_M = 60.0, 40.0
"""Width and depth of the building for which the sizes of the scene and rviz/robotteamsim.rviz were made."""

PITCH_RAD = 1.12
"""Of the camera of the default view, which looks north and down."""

_SUN_AZIMUTH_RAD = 0.75 * math.pi


def unit(bounds: Bounds) -> float:
    """Return the size of a building relative to FITTED_M; sizes in proportion to it are equal on the screen."""
    sides_m = (high - low for low, high in zip(bounds.min, bounds.max, strict=True))
    return max(side_m / fitted_m for side_m, fitted_m in zip(sides_m, FITTED_M, strict=True))


def colour(code: str, alpha: float = 1.0) -> Colour:
    """Return the colour of a code of the palette."""
    return (*palette.rgb(code), alpha)


WHITE, SKIN = colour(palette.WHITE), colour(palette.SKIN)

# Parts of a person: whether it is dressed, place along the body and above the floor, and size [m].
_LYING = ((False, 0.72, 0.13, (0.26, 0.24, 0.26)), (True, 0.0, 0.15, (1.3, 0.52, 0.3)))
# Larger than life: from above, one sees little of them.
_UPRIGHT = ((False, 0.0, 2.4, (0.6, 0.6, 0.55)), (True, 0.0, 1.2, (0.5, 0.85, 2.0)))


def faded(base: Colour, alpha: float) -> Colour:
    """Return the same hue with another opacity."""
    return (*base[:3], alpha)


def shaded(base: Colour, factor: float) -> Colour:
    """Return the colour darkened (factor below 1) or brightened, with the same opacity."""
    red, green, blue = (min(1.0, part * factor) for part in base[:3])
    return (red, green, blue, base[3])


def label(namespace: str, marker_id: int, words: str, tint: Colour, position: Position, height_m: float) -> Marker:
    """Return a text that faces the viewer, in a light tone of `tint`.

    Args: position: x and y of the place on the floor at which the default view sees it, and its height above the floor.
          height_m: of a capital letter.
    """
    (red, green, blue, _), (x, y, z) = tint, position
    light = (0.5 + 0.5 * red, 0.5 + 0.5 * green, 0.5 + 0.5 * blue, 1.0)
    at, scale = (x, y - z / math.tan(PITCH_RAD), z), (0.0, 0.0, height_m)
    return Marker(namespace, marker_id, TEXT_VIEW_FACING, light, at, scale=scale, text=words)


def lines(
    namespace: str, marker_id: int, segments: Iterable[tuple[Position, Position, Colour]], width_m: float
) -> Marker:
    """Return one marker of many straight lines, each with its own colour."""
    result = Marker(namespace, marker_id, LINE_LIST, WHITE, scale=(width_m, 0.0, 0.0))
    for start, end, tint in segments:
        result.points += [start, end]
        result.tints += [tint] * 2
        result.tint = faded(WHITE, min(result.tint[3], tint[3]))  # rviz blends lines only where this is below 1
    return result


def drawn_below(item: Marker, layer: int) -> Marker:
    """Return the marker, changed so that rviz paints it before transparent markers in lower layers or in none.

    rviz paints transparent markers from the farthest to the nearest origin of their poses. The origin is therefore
    lowered below the floor, and the points are raised by the same amount. It is not lower than necessary, because rviz
    computes with 24 bits and the layers are a centimetre apart.
    """
    depth_m = 100.0 + 5.0 * layer
    x_m, y_m, z_m = item.position
    item.position = (x_m, y_m, z_m - depth_m)
    item.points = [(x_m, y_m, z_m + depth_m) for x_m, y_m, z_m in item.points]
    return item


def person(
    namespace: str, number: int, pose: Pose, clothes: Colour, *, head: Colour = SKIN, lies: bool, raised_m: float = 0.0
) -> list[Marker]:
    """Return head and body. Args: number: of the person.  raised_m: height above the floor of one who is carried."""
    found = []
    for i, (dressed, along_m, z_m, size_m) in enumerate(_LYING if lies else _UPRIGHT):
        at, tint = pose @ Pose(along_m, 0.0, 0.0), clothes if dressed else head
        place = (at.x_m, at.y_m, z_m + raised_m)
        found.append(Marker(namespace, 2 * number + i, SPHERE, tint, place, pose.yaw_rad, size_m))
    return found


def circle_points(radius_m: float, sides: int = 48) -> list[tuple[float, float]]:
    """Return the corners of a regular polygon around the origin, counter-clockwise, the first one again at the end."""
    angles_rad = (math.tau * i / sides for i in range(sides + 1))
    return [(radius_m * math.cos(angle), radius_m * math.sin(angle)) for angle in angles_rad]


class Mesh:
    """Triangles with a colour per corner, collected into one marker.

    rviz does not light triangles with colours, so the colours include light and shade.
    """

    def __init__(self) -> None:
        self._points: list[Position] = []
        self._colours: list[Colour] = []

    def triangle(self, corners: Sequence[Position], tints: Sequence[Colour]) -> None:
        """Add one triangle with a colour per corner."""
        self._points += corners
        self._colours += tints

    def quad(self, corners: Sequence[Position], tints: Sequence[Colour]) -> None:
        """Add a quadrilateral; corners in order around it."""
        for i, j, k in ((0, 1, 2), (0, 2, 3)):
            self.triangle((corners[i], corners[j], corners[k]), (tints[i], tints[j], tints[k]))

    def polygon(self, shape: shapely.Geometry, z_m: float, tint: Colour) -> None:
        """Add a flat polygon, with holes or of several parts, at a height."""
        for part in shapely.constrained_delaunay_triangles(shape).geoms:
            self.triangle([(x, y, z_m) for x, y in part.exterior.coords[:3]], [tint] * 3)

    def prism(self, shape: shapely.Geometry, low_m: float, high_m: float, tint: Colour) -> None:
        """Add the top and the sides of an upright prism over polygons: bright towards the sun, darker below."""
        self.polygon(shape, high_m, tint)
        for part in shapely.get_parts(shape):
            outline = orient(part)  # its inside is to the left of every loop
            for loop in (outline.exterior, *outline.interiors):
                for (x0, y0), (x1, y1) in itertools.pairwise(loop.coords):
                    facing_rad = math.atan2(y1 - y0, x1 - x0) - math.pi / 2.0
                    light = 0.62 + 0.2 * math.cos(facing_rad - _SUN_AZIMUTH_RAD)
                    high, low = shaded(tint, light), shaded(tint, 0.62 * light)
                    corners = [(x0, y0, low_m), (x1, y1, low_m), (x1, y1, high_m), (x0, y0, high_m)]
                    self.quad(corners, [low, low, high, high])

    def ring(self, center_m: tuple[float, float], inner_m: float, outer_m: float, z_m: float, tint: Colour) -> None:
        """Add a flat ring, or a disc if the inner radius is 0."""
        x_m, y_m = center_m
        edges = (itertools.pairwise(circle_points(radius_m)) for radius_m in (inner_m, outer_m))
        for (inner, next_inner), (outer, next_outer) in zip(*edges, strict=True):
            corners = [(x_m + x, y_m + y, z_m) for x, y in (inner, outer, next_outer, next_inner)]
            self.quad(corners, [tint] * 4)

    def marker(self, namespace: str, marker_id: int) -> Marker:
        """Return the collected triangles as one marker."""
        return Marker(namespace, marker_id, TRIANGLE_LIST, WHITE, points=self._points, tints=self._colours)
