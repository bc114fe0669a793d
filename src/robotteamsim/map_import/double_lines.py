"""Walls that a drawing shows as two lines: the lines are the faces, the wall is what is between them."""

from __future__ import annotations

import numpy as np
import shapely

THICKEST_M = 0.6
"""Parallel lines closer than this are the faces of one wall, and outlines that are narrower everywhere are solid."""

MOST_PAIRS = 2_000_000
"""Of lines closer than that: a plan of 100,000 lines has about ten for each line; a hatch has more."""

_PARALLEL = 0.05
"""Largest sine of the angle between the faces of a wall."""

_GRID_M = 1e-4
"""Ends of lines meet if they are within this distance."""

_NEAR_M = 0.002
"""A line this close to a solid is its face."""

_SHORTEST_M = 0.01
"""Shorter parts of a line outside its wall are left out."""

_CHUNK = 100
"""Lines whose neighbours are searched at once."""


def solids_between(lines: np.ndarray) -> tuple[list[shapely.Polygon], np.ndarray]:
    """Return what is solid between lines, and the lines, or parts of them, that are no faces of it.

    Solid are the strips between parallel lines next to each other, and areas enclosed by lines that are nowhere as wide
    as THICKEST_M: corners and junctions of such walls, and pillars. A line that a wall only crosses stays whole.

    Args:    lines: float64, shape (n, 2, 2), start and end of each [m].
    Returns: polygons that do not touch each other [m]; lines of the same form.
    Raises:  ValueError: more than MOST_PAIRS pairs of lines are closer than THICKEST_M to each other.
    """
    shapes = shapely.linestrings(lines)
    strips = _strips(lines, _near_pairs(shapes))
    borders = shapely.union_all([*shapes, *shapely.boundary(strips)], grid_size=_GRID_M)
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(borders)))
    is_solid = shapely.is_empty(shapely.buffer(faces, _NEAR_M - THICKEST_M / 2.0))
    within, _ = shapely.STRtree(strips).query(shapely.point_on_surface(faces), predicate="within")
    is_solid[within] = True
    solid = shapely.union_all(faces[is_solid])
    polygons = shapely.get_parts(shapely.simplify(solid, 2.0 * _GRID_M)).tolist()
    return polygons, _uncovered(lines, shapes, faces[is_solid])


def _near_pairs(shapes: np.ndarray) -> np.ndarray:
    """Return the indices of lines closer than THICKEST_M to each other, the smaller first; int, shape (n, 2)."""
    tree, found, count = shapely.STRtree(shapes), [np.empty((0, 2), dtype=int)], 0
    for first in range(0, len(shapes), _CHUNK):
        chunk = shapes[first : first + _CHUNK]
        one, other = tree.query(chunk, predicate="dwithin", distance=THICKEST_M)
        one += first
        found.append(np.stack([one, other], axis=1)[one < other])
        count += len(found[-1])
        if count > MOST_PAIRS:
            raise ValueError(f"more than {MOST_PAIRS} pairs of lines are closer than {THICKEST_M} m; are they a hatch?")
    return np.concatenate(found)


def _strips(lines: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """Return the quadrilateral between two lines, over the length that they share, for each pair of faces."""
    one, other = lines[pairs[:, 0]], lines[pairs[:, 1]]
    along, beside = one[:, 1] - one[:, 0], other[:, 1] - other[:, 0]
    lengths_m = np.hypot(*along.T)
    along = along / lengths_m[:, None]
    sine = _cross(along, beside) / np.hypot(*beside.T)
    # Both lines over the length of the first: places of the second one's ends, in order.
    places = np.einsum("nij,nj->ni", other - one[:, :1], along)
    order = np.argsort(places, axis=1)
    places, other = np.take_along_axis(places, order, axis=1), np.take_along_axis(other, order[:, :, None], axis=1)
    low, high = np.maximum(places[:, 0], 0.0), np.minimum(places[:, 1], lengths_m)
    kept = (np.abs(sine) < _PARALLEL) & (high - low > _NEAR_M)
    one, other, along, places, low, high = (rows[kept] for rows in (one, other, along, places, low, high))
    share = (np.stack([low, high], axis=1) - places[:, :1]) / (places[:, 1:] - places[:, :1])
    near = one[:, :1] + np.stack([low, high], axis=1)[:, :, None] * along[:, None]
    far = other[:, :1] + share[:, :, None] * (other[:, 1:] - other[:, :1])
    depths_m = _cross(along[:, None], far - near)
    between = (np.abs(depths_m) > _NEAR_M).all(axis=1) & (np.abs(depths_m) < THICKEST_M - _NEAR_M).all(axis=1)
    between &= depths_m[:, 0] * depths_m[:, 1] > 0.0
    corners = np.concatenate([near, far[:, ::-1]], axis=1)[between]
    strips: np.ndarray = shapely.polygons(corners)
    return strips


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    product: np.ndarray = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return product


def _uncovered(lines: np.ndarray, shapes: np.ndarray, solid: np.ndarray) -> np.ndarray:
    """Return the parts of lines outside polygons; two parts with little between them are one."""
    line, face = shapely.STRtree(solid).query(shapes, predicate="dwithin", distance=_NEAR_M)
    common = shapely.intersection(shapes[line], shapely.buffer(solid, _NEAR_M)[face])
    pieces, index = shapely.get_parts(common, return_index=True)
    covered: dict[int, list[tuple[float, float]]] = {}
    for piece, number in zip(pieces, line[index].tolist(), strict=True):
        low, *_, high = sorted(shapely.line_locate_point(shapes[number], shapely.points(piece.coords)).tolist())
        covered.setdefault(number, []).append((low + _NEAR_M, high - _NEAR_M))
    rests = [lines[[number for number in range(len(lines)) if number not in covered]]]
    for number, places in covered.items():
        length_m = shapes[number].length
        parts: list[list[float]] = []
        reached = 0.0
        for low, high in [*sorted(places), (length_m, length_m)]:
            if low - reached > _SHORTEST_M:
                if parts and reached - parts[-1][1] < THICKEST_M:
                    parts[-1][1] = low
                else:
                    parts.append([reached, low])
            reached = max(reached, high)
        direction = (lines[number, 1] - lines[number, 0]) / length_m
        rests.append(lines[number, 0] + np.array(parts).reshape(-1, 2, 1) * direction)
    return np.concatenate(rests)
