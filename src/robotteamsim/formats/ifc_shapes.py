"""What a solid has between two heights, seen from above, and whether that is a straight wall."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import shapely

from robotteamsim.scenario.base import Point
from robotteamsim.scenario.plan import Corners, rectangle_of, strip_corners

FLAT_M = 1e-3
"""Outlines are this exact; so is the mesh of a curve [ifcopenshell 0.9, mesher-linear-deflection]."""

GRID_M = 1e-6
_INSIDE_M, _NEXT_M = 1e-4, 1.7e-5
"""How far within both heights a solid is cut, and by how much farther where it has a corner just there."""

_TOUCH_M = 0.005
"""How far walls that touch may be apart, or into one another."""

_LEAST_M2 = 1e-6
_FLAT_M2 = 1e-9
"""Seen from above, twice the area of a triangle that is upright but for rounding."""


class Mesh(NamedTuple):
    """The surface of a solid in the world: closed triangles.

    corners: float64, shape (n, 3, 3): three points [m].
    items:   int, shape (n,): which part of the solid each belongs to; parts may overlap.
    """

    corners: np.ndarray
    items: np.ndarray

    @property
    def low_m(self) -> float:
        """The lowest height."""
        return float(self.corners[..., 2].min())

    @property
    def high_m(self) -> float:
        """The greatest height."""
        return float(self.corners[..., 2].max())


def footprint(mesh: Mesh, low_m: float, high_m: float) -> list[shapely.Polygon]:
    """Return what lies below or above any part of a solid that is between two heights [m].

    A vertical line through a solid enters or leaves it at its surface, or at one of both heights: so that is the union
    of the surface between them, and of the sections at both.
    """
    points = mesh.corners
    heights = points[..., 2]
    between = (heights.max(axis=1) > low_m) & (heights.min(axis=1) < high_m)
    sides = points[:, 1:, :2] - points[:, :1, :2]
    is_flat = np.abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]) > _FLAT_M2
    faces = [clipped(corners, low_m, high_m) for corners in points[between & is_flat]]
    parts: list[shapely.Geometry] = [shapely.Polygon(face[:, :2]) for face in faces if len(face) > 2]
    for height_m in (_cut_m(heights, low_m, 1.0), _cut_m(heights, high_m, -1.0)):
        for item in np.unique(mesh.items):
            parts.append(_section(points[mesh.items == item], height_m))
    whole = shapely.simplify(shapely.union_all(shapely.make_valid(parts), grid_size=GRID_M), FLAT_M / 10.0)
    return [
        part for part in shapely.get_parts(whole) if isinstance(part, shapely.Polygon) and part.buffer(-FLAT_M).area
    ]


def _cut_m(heights: np.ndarray, begin_m: float, sign: float) -> float:
    """Return a height just within one of both where no corner is."""
    cuts = (begin_m + sign * (_INSIDE_M + _NEXT_M * step) for step in itertools.count())
    return next(cut for cut in cuts if np.abs(heights - cut).min() > _NEXT_M / 100.0)


def clipped(corners: np.ndarray, low_m: float, high_m: float) -> np.ndarray:
    """Return the part of a convex polygon between two heights; float64, shape (n, 3)."""
    for sign, height_m in ((1.0, low_m), (-1.0, high_m)):
        inside = sign * (corners[:, 2] - height_m)
        if inside.min() >= 0.0:
            continue
        found = []
        for one, other, here, there in zip(
            corners, np.roll(corners, -1, axis=0), inside, np.roll(inside, -1), strict=True
        ):
            found += [one] if here >= 0.0 else []
            found += [one + (here / (here - there)) * (other - one)] if here * there < 0.0 else []
        corners = np.array(found).reshape(-1, 3)
        if not len(corners):
            break
    return corners


def _section(triangles: np.ndarray, height_m: float) -> shapely.Geometry:
    """Return the section of a closed surface, no corner of which is at that height."""
    above = triangles[..., 2] > height_m
    crossing = triangles[above.any(axis=1) & ~above.all(axis=1)]
    if not len(crossing):
        return shapely.Polygon()
    # Both triangles at an edge give the same point: the lower end of the edge comes first.
    edges = np.stack([crossing, np.roll(crossing, -1, axis=1)], axis=2)
    order = np.argsort(edges[..., 2], axis=2)
    edges = np.take_along_axis(edges, order[..., None], axis=2)
    low, high = edges[:, :, 0], edges[:, :, 1]
    crosses = (low[..., 2] < height_m) & (high[..., 2] > height_m)
    share = (height_m - low[crosses][:, 2]) / (high[crosses][:, 2] - low[crosses][:, 2])
    points = low[crosses][:, :2] + share[:, None] * (high[crosses] - low[crosses])[:, :2]
    lines = shapely.linestrings(points.round(6).reshape(-1, 2, 2))
    return shapely.build_area(shapely.union_all(lines, grid_size=GRID_M))


class Strip(NamedTuple):
    """A rectangle around a centre line, which begins at `start`; `along` is its direction [m, map]."""

    start: np.ndarray
    along: np.ndarray
    length_m: float
    thickness_m: float

    def at(self, along_m: float) -> Point:
        """Return a point of the centre line."""
        x, y = (self.start + along_m * self.along).round(6).tolist()
        return x, y

    def polygon(self, from_m: float, to_m: float) -> shapely.Polygon:
        """Return the part of the strip between two places on its centre line."""
        one, other = (self.start + along_m * self.along for along_m in (from_m, to_m))
        return shapely.Polygon(strip_corners(tuple(one.tolist()), tuple(other.tolist()), self.thickness_m))

    def opened_by(self, gap: shapely.Geometry, share: float) -> tuple[float, float] | None:
        """Return where on the centre line a gap takes away that share of the thickness; None: nowhere."""
        cut = shapely.intersection(self.polygon(0.0, self.length_m), gap)
        if cut.area < _LEAST_M2:
            return None
        low_m, high_m = spanned(cut, self.start, self.along)
        opens = cut.area > share * (high_m - low_m) * self.thickness_m
        return (low_m, high_m) if opens else None


THROUGH = 0.9
"""Share of the thickness of a wall that an opening through it takes away."""


def spanned(shape: shapely.Geometry, start: np.ndarray, along: np.ndarray) -> tuple[float, float]:
    """Return the least and greatest place of a shape along a line [m]."""
    places = (shapely.get_coordinates(shape) - start) @ along
    return float(places.min()), float(places.max())


def as_strip(polygon: shapely.Polygon) -> Strip | None:
    """Return a straight wall; None: it is not one.

    Its ends may be cut, or notched, where it meets others, over at most its thickness: it is straight up to there.
    """
    around = shapely.oriented_envelope(polygon)
    if not isinstance(around, shapely.Polygon):
        return None
    corners: Corners = tuple(map(tuple, shapely.get_coordinates(around)[:4].tolist()))
    if (rectangle := rectangle_of(corners)) is None:
        return None
    sides = np.subtract(corners[1], corners[0]), np.subtract(corners[2], corners[1])
    is_first = rectangle.length_m >= rectangle.width_m
    length_m, thickness_m = sorted((rectangle.length_m, rectangle.width_m), reverse=True)
    along = sides[0 if is_first else 1] / length_m
    start = np.mean(corners, axis=0) - 0.5 * length_m * along
    strip = Strip(start, along, length_m, round(thickness_m, 4))
    missing = around.area - polygon.area
    if missing <= FLAT_M * polygon.length:
        return strip
    if length_m <= 3.0 * thickness_m:
        return None
    middle = strip.polygon(thickness_m, length_m - thickness_m)
    return strip if middle.difference(polygon).area <= FLAT_M * polygon.length else None


def face_to_face(strips: Sequence[Strip]) -> set[int]:
    """Return the indices of straight walls that touch a parallel one along their length, such as furring."""
    shapes = np.array([strip.polygon(0.0, strip.length_m) for strip in strips], dtype=object)
    found: set[int] = set()
    for i, j in shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=_TOUCH_M).T.tolist():
        one, half_m = strips[i], 0.5 * strips[i].thickness_m
        begin_m, end_m = spanned(shapes[j], one.start, one.along)
        right_m, left_m = spanned(shapes[j], one.start, np.array([-one.along[1], one.along[0]]))
        is_parallel = left_m - right_m < strips[j].thickness_m + _TOUCH_M
        touches = min(abs(right_m - half_m), abs(left_m + half_m)) < _TOUCH_M
        if is_parallel and touches and min(end_m, one.length_m) - max(begin_m, 0.0) > one.thickness_m:
            found |= {i, j}
    return found


def without_holes(polygon: shapely.Polygon) -> Iterator[shapely.Polygon]:
    """Yield a polygon in parts that have no holes, by cuts through the middle of each hole."""
    if not polygon.interiors:
        yield polygon
        return
    x = shapely.Polygon(polygon.interiors[0]).centroid.x
    min_x, min_y, max_x, max_y = polygon.bounds
    for half in (shapely.box(min_x, min_y, x, max_y), shapely.box(x, min_y, max_x, max_y)):
        for part in shapely.get_parts(shapely.intersection(polygon, half)):
            if isinstance(part, shapely.Polygon):
                yield from without_holes(part)


def outlines(shape: shapely.Geometry) -> Iterator[tuple[list[Point], float]]:
    """Yield the corners and areas of the parts of a shape, without holes and without details below 1 cm [m, m2]."""
    for part in shapely.get_parts(shapely.simplify(shape, 10.0 * FLAT_M)):
        for piece in without_holes(part):
            for outline in shapely.get_parts(shapely.set_precision(piece, GRID_M)):
                if isinstance(outline, shapely.Polygon) and outline.area > FLAT_M**2:
                    corners = shapely.get_coordinates(outline.exterior)[:-1].round(6)
                    yield [(x, y) for x, y in corners.tolist()], outline.area


def remaining(length_m: float, gaps: Sequence[tuple[float, float]]) -> Iterator[tuple[float, float]]:
    """Yield what gaps leave of a line that begins at 0, in order; pieces below FLAT_M are left out."""
    begin_m = 0.0
    for low_m, high_m in (*sorted(gaps), (length_m, length_m)):
        if low_m - begin_m > FLAT_M:
            yield begin_m, low_m
        begin_m = max(begin_m, high_m)
