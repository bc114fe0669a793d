"""Converts solid cells to pieces: thin axis-aligned rectangles become straight walls, other pieces polygons."""

import math
from collections import defaultdict
from dataclasses import dataclass

import numpy as np
import shapely

from robotteamsim.map_import.inner_corners import cut_at_inner_corners
from robotteamsim.map_import.outlines import outlines
from robotteamsim.map_import.thickness import piece_thickness

MAX_WALL_THICKNESS_M = 0.8
"""Last limit of the loss table: a thicker rectangle is a polygon."""

THICKEST_M = 1.0
"""Thicker walls count as this: the loss table does not distinguish them."""

MIN_PIECE_M2 = 1e-6
"""Smaller pieces are omitted."""

PointM = tuple[float, float]
Corner = tuple[float, float]
Ring = list[Corner]


@dataclass(frozen=True, slots=True)
class StraightPiece:
    """An axis-aligned rectangle as a wall along its longer centre line [m]."""

    start: PointM
    end: PointM
    thickness_m: float


@dataclass(frozen=True, slots=True)
class PolygonPiece:
    """A convex polygon [m].

    thickness_m: of the wall that it is part of, which determines the loss; None if it has no outer face.
    """

    corners: tuple[PointM, ...]
    thickness_m: float | None


Piece = StraightPiece | PolygonPiece


def solid_pieces(solid: np.ndarray, low_m: PointM, cell_m: PointM) -> list[Piece]:
    """Return pieces whose union is the solid cells.

    Edges along the axes stay on the cells' borders; staircases become the straight lines that produce them. The solid
    area is cut where walls meet, then into convex pieces: axis-aligned rectangles up to 0.8 m thick are straight
    pieces, all others polygons. The loss of a piece follows from the thickness of the wall that it is part of, in whole
    cells.

    Args:   solid: bool, shape (rows, cols), row 0 at the lowest y; no two cells touch only at a corner.
            low_m: lower left corner of cell (0, 0). cell_m: width and height of a cell, about equal.
    """
    edge_m = math.sqrt(cell_m[0] * cell_m[1])
    found: list[Piece] = []
    for polygon in outlines(solid):
        parts = cut_at_inner_corners(polygon, MAX_WALL_THICKNESS_M / edge_m)
        pieces = [piece for part in parts for piece in convex_pieces(part)]
        cells = np.maximum(piece_thickness(polygon, pieces, THICKEST_M / edge_m).round(), 1.0)
        for piece, thickness_m in zip(pieces, (cells * edge_m).round(6).tolist(), strict=True):
            corners = tuple((float(x), float(y)) for x, y in in_metres(low_m, cell_m, piece).tolist())
            straight = _as_straight(corners)
            if straight and (math.isnan(thickness_m) or straight.thickness_m == thickness_m):
                found.append(straight)
            elif _is_sound(corners):
                found.append(PolygonPiece(corners, None if math.isnan(thickness_m) else thickness_m))
    return found


def convex_pieces(polygon: shapely.Polygon) -> list[np.ndarray]:
    """Return convex pieces whose union is a polygon with holes; corners counter-clockwise, float64, shape (n, 2).

    Triangles of the constrained Delaunay triangulation are merged across their longest common edges first while the
    result stays convex (Hertel and Mehlhorn 1983), so that a straight section of wall becomes one piece.
    """
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(polygon))
    pieces = {i: [(x, y) for x, y in shapely.get_coordinates(t)[:3]] for i, t in enumerate(triangles)}
    pieces = {i: ring if _turn(*ring) > 0.0 else ring[::-1] for i, ring in pieces.items()}
    sides = defaultdict(list)
    for i, ring in pieces.items():
        for a, b in zip(ring, (*ring[1:], ring[0]), strict=True):
            sides[min(a, b), max(a, b)].append(i)
    shared = [(edge, owners) for edge, owners in sides.items() if len(owners) == 2]
    shared.sort(key=lambda item: (-np.hypot(*np.subtract(*item[0])), item[0]))
    home = {i: i for i in pieces}
    for (a, b), owners in shared:
        one, other = (_root(home, owner) for owner in owners)
        merged = _merged(pieces[one], pieces[other], a, b)
        if merged is not None:
            pieces[one] = merged
            del pieces[other]
            home[other] = one
    return [np.array(_without_straight_corners(ring)) for ring in pieces.values()]


def _turn(a: Corner, b: Corner, c: Corner) -> float:
    """Return twice the area of a triangle, positive if a, b, c turn left."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _root(home: dict[int, int], piece: int) -> int:
    while home[piece] != piece:
        piece = home[piece]
    return piece


def _merged(one: Ring, other: Ring, a: Corner, b: Corner) -> Ring | None:
    """Return two convex rings joined along the edge a-b; None: the result is not convex."""
    if one[one.index(a) - len(one) + 1] != b:
        a, b = b, a
    # `one` runs a -> b along the edge, `other` b -> a.
    first, second = one.index(b), other.index(a)
    ring = one[first:] + one[:first] + (other[second:] + other[:second])[1:-1]
    for corner in (ring.index(a), 0):
        if _turn(ring[corner - 1], ring[corner], ring[(corner + 1) % len(ring)]) < 0.0:
            return None
    return ring


def _without_straight_corners(ring: Ring) -> Ring:
    return [p for i, p in enumerate(ring) if _turn(ring[i - 1], p, ring[(i + 1) % len(ring)]) > 0.0]


def in_metres(low_m: PointM, cell_m: PointM, cells: np.ndarray) -> np.ndarray:
    """Convert points from cells to `map` [m], in whole micrometres to keep rounding errors out of the plan file."""
    points_m: np.ndarray = np.round(np.array(low_m) + cells * np.array(cell_m), 6)
    return points_m


def _is_sound(corners: tuple[PointM, ...]) -> bool:
    """Whether a piece is more than a sliver from rounding."""
    polygon = shapely.Polygon(corners)
    return bool(polygon.is_valid and polygon.area > MIN_PIECE_M2)


def _as_straight(corners: tuple[PointM, ...]) -> StraightPiece | None:
    """Return a thin axis-aligned rectangle as a straight piece; None if the polygon is not one."""
    (min_x, min_y), (max_x, max_y) = np.min(corners, axis=0).tolist(), np.max(corners, axis=0).tolist()
    width, depth = max_x - min_x, max_y - min_y
    thickness = round(min(width, depth), 6)
    upright = len(corners) == 4 and abs(shapely.Polygon(corners).area - width * depth) < 1e-9
    if not upright or thickness > MAX_WALL_THICKNESS_M:
        return None
    if width >= depth:
        y = round((min_y + max_y) / 2.0, 6)
        return StraightPiece((min_x, y), (max_x, y), thickness)
    x = round((min_x + max_x) / 2.0, 6)
    return StraightPiece((x, min_y), (x, max_y), thickness)
