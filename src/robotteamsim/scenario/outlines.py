"""From cells to vectors: outlines of solid cells, staircases made straight, cut into convex pieces."""

from __future__ import annotations

from collections import defaultdict

import numpy as np
import shapely

Corner = tuple[float, float]
Ring = list[Corner]

LONG_EDGE_CELLS = 8.0
"""An edge along an axis of this length is a wall's face and stays where it is; shorter ones may be a staircase."""

TOLERANCE_CELLS = 0.75
"""Straight lines pass this near the middles of a staircase's steps. It is less than what is one cell wide."""


def outlines(solid: np.ndarray) -> list[shapely.Polygon]:
    """Return the outlines of solid cells with staircases made straight, in cells; holes are kept.

    Args: solid: bool, shape (rows, cols), row 0 at the lowest y; no two cells touch by a corner alone.
    """
    edges = np.diff(np.pad(solid, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    rows, first = np.nonzero(edges == 1)
    last = np.nonzero(edges == -1)[1]
    exact = shapely.union_all(shapely.box(first, rows, last, rows + 1))
    return [_straightened(polygon) for polygon in shapely.get_parts(exact)]


def convex_pieces(polygon: shapely.Polygon) -> list[np.ndarray]:
    """Return convex pieces that fill a polygon with holes; corners counter-clockwise, float64, shape (n, 2).

    Triangles of the constrained Delaunay triangulation, merged across their longest common edges first while the
    result stays convex (Hertel and Mehlhorn 1983): a straight stretch of wall becomes one piece.
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


def _straightened(polygon: shapely.Polygon) -> shapely.Polygon:
    """Return a polygon along cell borders with straight lines for staircases, or as it is where those would cross."""
    exact = shapely.simplify(polygon, 0.0)
    shell, *holes = (_straight_ring(shapely.get_coordinates(r)[:-1]) for r in (exact.exterior, *exact.interiors))
    straight = shapely.Polygon(shell, holes)
    return straight if straight.is_valid else exact


def _straight_ring(corners: np.ndarray) -> np.ndarray:
    """Return a ring of edges along the axes with straight lines for its staircases; float64, shape (n, 2).

    A step is a short edge between two opposite turns; its middle lies on the line that the staircase stands for.
    """
    edges = np.roll(corners, -1, axis=0) - corners
    before = np.roll(edges, 1, axis=0)
    turns = np.sign(before[:, 0] * edges[:, 1] - before[:, 1] * edges[:, 0])
    long = np.abs(edges).sum(axis=1) >= LONG_EDGE_CELLS
    steps = ~long & (turns != np.roll(turns, -1))
    points: Ring = []
    cuts: list[int] = []
    for i, step in enumerate(steps):
        if step:
            points.append(tuple((corners[i] + 0.5 * edges[i]).tolist()))
        else:
            cuts += [len(points), len(points) + 1] if long[i] else []
            points += [tuple(corners[i].tolist()), tuple((corners[i] + edges[i]).tolist())]
    return _simplified(np.array(points), cuts or [0])


def _simplified(points: np.ndarray, cuts: list[int]) -> np.ndarray:
    """Drop the points of a ring that lie within the tolerance of a line; the points at `cuts` stay."""
    kept = []
    for start, end in zip(cuts, [*cuts[1:], cuts[0] + len(points)], strict=True):
        chain = points[np.arange(start, end + 1) % len(points)]
        kept.append(shapely.get_coordinates(shapely.simplify(shapely.LineString(chain), TOLERANCE_CELLS))[:-1])
    ring = np.concatenate(kept)
    ring = ring[np.any(ring != np.roll(ring, 1, axis=0), axis=1)]
    return ring if len(ring) > 2 else points


def _turn(a: Corner, b: Corner, c: Corner) -> float:
    """Return twice the area of a triangle, positive when a, b, c turn left."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _root(home: dict[int, int], piece: int) -> int:
    while home[piece] != piece:
        piece = home[piece]
    return piece


def _merged(one: Ring, other: Ring, a: Corner, b: Corner) -> Ring | None:
    """Return two convex rings joined along the edge a-b, or none where the result is not convex."""
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
