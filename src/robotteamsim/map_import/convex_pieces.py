"""Cutting a polygon with holes into convex pieces."""

from collections import defaultdict

import numpy as np
import shapely

Corner = tuple[float, float]
Ring = list[Corner]


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
