"""Building blocks of the 3D scene: colours, markers, triangle meshes, and deletion of markers."""

import itertools
import math
from collections.abc import Iterable, Sequence

import shapely
from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker

from robotteamsim import palette

FRAME = "map"

# Flat transparent layers on the floor, from top to bottom; see `drawn_below`.
TRAIL_LAYER = 1
DISC_LAYER = 2
CONTOUR_LAYER = 3
VOICE_LAYER = 4
SHADOW_LAYER = 5

Colour = tuple[float, float, float, float]
"""Red, green, blue and opacity, each 0..1."""

Position = tuple[float, float, float]
"""x, y, z in the map frame, or in the frame of the marker's own pose [m]."""


def colour(code: str, alpha: float = 1.0) -> Colour:
    """Return the colour of a code of the palette."""
    return (*palette.rgb(code), alpha)


WHITE = colour(palette.WHITE)


def faded(base: Colour, alpha: float) -> Colour:
    """Return the same hue with another opacity."""
    return (*base[:3], alpha)


def shaded(base: Colour, factor: float) -> Colour:
    """Return the colour darkened (factor below 1) or brightened, with the same opacity."""
    red, green, blue = (min(1.0, part * factor) for part in base[:3])
    return (red, green, blue, base[3])


def mixed(low: Colour, high: Colour, share: float) -> Colour:
    """Return the colour at a fraction `share` (0..1) from `low` to `high`."""
    red, green, blue, alpha = (a + share * (b - a) for a, b in zip(low, high, strict=True))
    return (red, green, blue, alpha)


def gradient(stops: Sequence[tuple[float, Colour]], value: float) -> Colour:
    """Return the colour of a value on a scale of ascending (value, colour) stops, clamped at both ends."""
    for (low, low_colour), (high, high_colour) in itertools.pairwise(stops):
        if value < high:
            return mixed(low_colour, high_colour, max(0.0, (value - low) / (high - low)))
    return stops[-1][1]


def marker(
    namespace: str,
    marker_id: int,
    kind: int,
    tint: Colour,
    *,
    position: Position = (0.0, 0.0, 0.0),
    yaw_rad: float = 0.0,
    scale: Position = (1.0, 1.0, 1.0),
) -> Marker:
    """Return a marker of a kind such as Marker.CYLINDER in the map frame.

    Its stamp is 0, "at any time", so that rviz needs no current transform, which a paused or slow world lacks.
    """
    result = Marker(ns=namespace, id=marker_id, type=kind, action=Marker.ADD, color=ColorRGBA(*tint))
    result.header.frame_id = FRAME
    result.pose.position = Point(*position)
    result.pose.orientation.z = math.sin(yaw_rad / 2.0)
    result.pose.orientation.w = math.cos(yaw_rad / 2.0)
    result.scale.x, result.scale.y, result.scale.z = scale
    return result


def label(namespace: str, marker_id: int, words: str, tint: Colour, position: Position, height_m: float) -> Marker:
    """Return a text that always faces the viewer, in a light tone of `tint` that is readable on a dark ground.

    `height_m` is the height of a capital letter.
    """
    light = faded(mixed(tint, WHITE, 0.5), 1.0)
    result = marker(namespace, marker_id, Marker.TEXT_VIEW_FACING, light, position=position, scale=(0.0, 0.0, height_m))
    result.text = words
    return result


def lines(
    namespace: str,
    marker_id: int,
    segments: Iterable[tuple[Position, Position, Colour]],
    width_m: float,
) -> Marker:
    """Return one marker of many straight lines, each with its own colour."""
    result = marker(namespace, marker_id, Marker.LINE_LIST, WHITE, scale=(width_m, 0.0, 0.0))
    for start, end, tint in segments:
        result.points += [Point(*start), Point(*end)]
        result.colors += [ColorRGBA(*tint)] * 2
        result.color.a = min(result.color.a, tint[3])  # rviz blends lines only where this is below 1
    return result


def drawn_below(item: Marker, layer: int) -> Marker:
    """Return the marker, changed so that rviz paints it before transparent markers in lower layers or in none.

    rviz paints transparent markers from the farthest to the nearest origin of their poses. The origin is therefore
    lowered below the floor, and the points are raised by the same amount. It is not lower than necessary, because rviz
    computes with 24 bits and the layers are a centimetre apart.
    """
    depth_m = 100.0 + 5.0 * layer
    item.pose.position.z -= depth_m
    for point in {id(point): point for point in item.points}.values():  # triangles may share their corners
        point.z += depth_m
    return item


def circle_points(radius_m: float, sides: int, closed: bool = False) -> list[tuple[float, float]]:
    """Return the corners of a regular polygon around the origin, counter-clockwise, the first again if closed [m]."""
    angles = (math.tau * i / sides for i in range(sides + closed))
    return [(radius_m * math.cos(angle), radius_m * math.sin(angle)) for angle in angles]


class Mesh:
    """Triangles with a colour per corner, collected into one marker.

    rviz does not light triangles with colours, so the colours include light and shade.
    """

    def __init__(self) -> None:
        self._points: list[Point] = []
        self._colours: list[ColorRGBA] = []

    def __len__(self) -> int:
        return len(self._points) // 3

    def triangle(self, corners: Sequence[Position], tints: Sequence[Colour]) -> None:
        """Add one triangle with a colour per corner."""
        self._points += [Point(*corner) for corner in corners]
        self._colours += [ColorRGBA(*tint) for tint in tints]

    def quad(self, corners: Sequence[Position], tints: Sequence[Colour]) -> None:
        """Add a quadrilateral; corners in order around it."""
        for i, j, k in ((0, 1, 2), (0, 2, 3)):
            self.triangle((corners[i], corners[j], corners[k]), (tints[i], tints[j], tints[k]))

    def sheet(self, corners: Sequence[Position], tints: Sequence[Colour], quads: Iterable[Sequence[int]]) -> None:
        """Add many quadrilaterals that share corners, each given by the indices of its four in order around it."""
        points = [Point(*corner) for corner in corners]
        colours = [ColorRGBA(*tint) for tint in tints]
        for a, b, c, d in quads:
            for index in (a, b, c, a, c, d):
                self._points.append(points[index])
                self._colours.append(colours[index])

    def polygon(self, shape: shapely.Geometry, z_m: float, tint: Colour) -> None:
        """Add a flat polygon, with holes or of several parts, at a height."""
        for part in shapely.constrained_delaunay_triangles(shape).geoms:
            self.triangle([(x, y, z_m) for x, y in part.exterior.coords[:3]], [tint] * 3)

    def prism(self, corners: Sequence[tuple[float, float]], low_m: float, high_m: float, tint: Colour) -> None:
        """Add the top and the darker sides of a vertical prism over a convex polygon, counter-clockwise."""
        top = [(x, y, high_m) for x, y in corners]
        for second, third in itertools.pairwise(top[1:]):
            self.triangle((top[0], second, third), [tint] * 3)
        dark = shaded(tint, 0.6)
        for (x0, y0), (x1, y1) in itertools.pairwise([*corners, corners[0]]):
            self.quad([(x0, y0, low_m), (x1, y1, low_m), (x1, y1, high_m), (x0, y0, high_m)], [dark] * 4)

    def ring(
        self, center_m: tuple[float, float], inner_m: float, outer_m: float, z_m: float, tint: Colour, dashes: int = 0
    ) -> None:
        """Add a flat ring, or a disc if the inner radius is 0. Args: dashes: number of dashes; 0: no gaps."""
        x_m, y_m = center_m
        inside, outside = (circle_points(radius_m, 48, closed=True) for radius_m in (inner_m, outer_m))
        for i, j in itertools.pairwise(range(len(inside))):
            if dashes and i * 2 * dashes // (len(inside) - 1) % 2:
                continue
            flat = (inside[i], outside[i], outside[j], inside[j])
            self.quad([(x_m + x, y_m + y, z_m) for x, y in flat], [tint] * 4)

    def marker(self, namespace: str, marker_id: int) -> Marker:
        """Return the collected triangles as one marker."""
        result = marker(namespace, marker_id, Marker.TRIANGLE_LIST, WHITE)
        result.points, result.colors = self._points, self._colours
        return result


class Shown:
    """Keeps track of the markers on a display, to delete those that are no longer drawn."""

    def __init__(self) -> None:
        self._keys: dict[tuple[str, int], None] | None = None

    def update(self, markers: Iterable[Marker]) -> list[Marker]:
        """Return the markers, preceded by deletions; the first time, of all markers of an earlier run."""
        wanted = list(markers)
        keys = dict.fromkeys((item.ns, item.id) for item in wanted)
        if self._keys is None:
            gone = [_deletion("", 0, Marker.DELETEALL)]
        else:
            gone = [_deletion(*key, Marker.DELETE) for key in self._keys if key not in keys]
        self._keys = keys
        return gone + wanted


def _deletion(namespace: str, marker_id: int, action: int) -> Marker:
    result = Marker(ns=namespace, id=marker_id, action=action)
    result.header.frame_id = FRAME
    result.pose.orientation.w = 1.0
    return result
