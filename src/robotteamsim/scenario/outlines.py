"""From cells to vectors: outlines of solid cells, staircases made straight, cut into convex pieces."""

from __future__ import annotations

from collections import defaultdict

import numpy as np
import shapely

LONG_EDGE_CELLS = 8.0
"""An edge along an axis of this length is a wall's face and stays where it is; shorter ones may be a staircase."""

STAIRCASE_TOLERANCE_CELLS = 1.0
"""How far a straightened staircase may lie beside the cells' borders; less leaves steps behind."""


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
    """Return a polygon along cell borders with straight lines for staircases, except where the lines would cross."""
    outline = shapely.simplify(polygon, 0.0)
    exact = [_chains(shapely.get_coordinates(ring)[:-1]) for ring in (outline.exterior, *outline.interiors)]
    rings = [_straight_ring(chains) for chains in exact]
    while not (straight := _as_polygon(rings)).is_valid:
        # The reason ends in the point where the lines meet: "Self-intersection[17.5 3]".
        spot = shapely.Point(*map(float, shapely.is_valid_reason(straight).partition("[")[2].rstrip("]").split()))
        places = [(r, c) for r, ring in enumerate(rings) for c in range(len(ring)) if rings[r][c] is not exact[r][c]]
        crossing = [(r, c) for r, c in places if shapely.LineString(rings[r][c]).distance(spot) < 1e-6]
        for r, c in crossing or places:
            rings[r][c] = exact[r][c]
    return straight


def _chains(corners: np.ndarray) -> list[np.ndarray]:
    """Cut a ring at the ends of its long edges; every chain begins where the one before it ends."""
    lengths = np.abs(np.roll(corners, -1, axis=0) - corners).sum(axis=1)
    long = np.flatnonzero(lengths >= LONG_EDGE_CELLS)
    cuts = np.unique(np.concatenate([long, long + 1]) % len(corners)) if len(long) else np.zeros(1, dtype=int)
    steps = np.diff(np.append(cuts, cuts[0] + len(corners)))
    return [corners[(cut + np.arange(step + 1)) % len(corners)] for cut, step in zip(cuts, steps, strict=True)]


def _straight_ring(chains: list[np.ndarray]) -> list[np.ndarray]:
    """Drop the corners of each chain that lie within the tolerance of a line; not where nothing would be left."""
    lines = [_straight_chain(chain) for chain in chains]
    return lines if sum(len(line) - 1 for line in lines) > 2 else list(chains)


def _straight_chain(chain: np.ndarray) -> np.ndarray:
    line = shapely.get_coordinates(shapely.simplify(shapely.LineString(chain), STAIRCASE_TOLERANCE_CELLS))
    return line if len(line) < len(chain) else chain


def _as_polygon(rings: list[list[np.ndarray]]) -> shapely.Polygon:
    shell, *holes = (np.concatenate([line[:-1] for line in ring]) for ring in rings)
    return shapely.Polygon(shell, holes)


def _turn(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    """Return twice the area of a triangle, positive when a, b, c turn left."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _root(home: dict[int, int], piece: int) -> int:
    while home[piece] != piece:
        piece = home[piece]
    return piece


def _merged(one: list, other: list, a: tuple, b: tuple) -> list | None:
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


def _without_straight_corners(ring: list) -> list:
    return [p for i, p in enumerate(ring) if _turn(ring[i - 1], p, ring[(i + 1) % len(ring)]) > 0.0]
