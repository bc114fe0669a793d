"""Crossings of walls, rounded outwards to whole millimetres so that no wall shrinks."""

import numpy as np
import shapely

_NEAR_MM = 3
"""Rounding moves a corner of the outline by less than this."""

_IN_NOTCHES_MM = 48
"""An acute notch between two walls is filled up to here, if it is wide enough for a lattice point; a tip never is."""


def round_outwards(ends_mm: np.ndarray, rings: np.ndarray, edges_mm: np.ndarray) -> np.ndarray:
    """Return the faces of a union, with its crossings moved to whole millimetres outside both crossing walls.

    Where two walls cross, the corner of the outline is rarely a lattice point. Rounded to the nearest one, it may bend
    a straight face into the wall, and a ray along the face, inside the wall, would leave and enter it at each crossing.
    A corner outside both walls, or on their faces, prevents this. Corners of the walls themselves are kept.

    Args:   ends_mm: int64, shape (n, 4): x1, y1, x2, y2 of each face, the solid to its left, ring after ring.
            rings: int64, shape (n,): ring of each face.
            edges_mm: int64, shape (m, 4): edges of the united solids.
    Returns: int64, shape (n, 4).
    """
    if len(ends_mm) == 0:
        return ends_mm
    lines = _lines(ends_mm, edges_mm)
    following = _following(rings)
    vertices, here, there = ends_mm[:, 2:], lines, lines[following]
    is_off = (_left(here, vertices) != 0) | (_left(there, vertices) != 0)
    is_notch = _left(ends_mm, ends_mm[following, 2:]) < 0
    moved, off = vertices.copy(), np.flatnonzero(is_off)
    moved[off], found = _outside(vertices[off], here[off], there[off], _NEAR_MM)
    for i in off[~found & is_notch[off]].tolist():
        moved[i], _ = _outside(vertices[i], here[i], there[i], _IN_NOTCHES_MM)
    starts = np.empty_like(moved)
    starts[following] = moved
    return np.hstack([starts, moved])


def _following(rings: np.ndarray) -> np.ndarray:
    """Return the index of the next face in the same ring."""
    following = np.arange(1, len(rings) + 1)
    last = np.flatnonzero(np.append(rings[1:] != rings[:-1], True))
    first = np.append(0, last[:-1] + 1)
    following[last] = first
    return following


def _lines(ends_mm: np.ndarray, edges_mm: np.ndarray) -> np.ndarray:
    """Return for each face the edge that it is a part of, in the same direction."""
    tree = shapely.STRtree(shapely.linestrings(edges_mm.reshape(-1, 2, 2)))
    starts, finishes = shapely.points(ends_mm[:, :2]), shapely.points(ends_mm[:, 2:])
    face, edge = tree.query(starts, predicate="dwithin", distance=_NEAR_MM)
    away = np.maximum(
        shapely.distance(starts[face], tree.geometries[edge]), shapely.distance(finishes[face], tree.geometries[edge])
    )
    # The nearest edge of each face is the last one written.
    lines = ends_mm.copy()
    by_distance = np.argsort(-away, kind="stable")
    near = by_distance[away[by_distance] <= _NEAR_MM]
    lines[face[near]] = edges_mm[edge[near]]
    along = np.sum((lines[:, 2:] - lines[:, :2]) * (ends_mm[:, 2:] - ends_mm[:, :2]), axis=1)
    backwards = along < 0
    lines[backwards] = lines[backwards][:, [2, 3, 0, 1]]
    return lines


def _left(lines: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return twice the area of the triangles of lines and points: > 0 if a point is to the left."""
    along, offset = lines[..., 2:] - lines[..., :2], points - lines[..., :2]
    return np.asarray(along[..., 0] * offset[..., 1] - along[..., 1] * offset[..., 0])


def _outside(
    vertices: np.ndarray, first: np.ndarray, second: np.ndarray, reach_mm: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return the lattice points nearest to crossings of two lines that are to the left of neither, and if there is one.

    Args:    vertices, first, second: int64, shape (..., 2), (..., 4) and (..., 4).
    Returns: int64, shape (..., 2), the vertex where no point within reach is outside; bool, shape (...).
    """
    steps = np.arange(-reach_mm, reach_mm + 1)
    offsets = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
    candidates = vertices[..., None, :] + offsets
    outside = (_left(first[..., None, :], candidates) <= 0) & (_left(second[..., None, :], candidates) <= 0)
    away = np.sum((candidates - _crossings(vertices, first, second)[..., None, :]) ** 2, axis=-1)
    nearest = np.argmin(np.where(outside, away, np.inf), axis=-1)
    found = np.any(outside, axis=-1)
    return np.where(found[..., None], vertices + offsets[nearest], vertices), found


def _crossings(vertices: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Return where two lines cross at each vertex [mm]; the vertex if they cross elsewhere."""
    d1, d2 = (first[..., 2:] - first[..., :2]).astype(float), (second[..., 2:] - second[..., :2]).astype(float)
    turn = d1[..., 0] * d2[..., 1] - d1[..., 1] * d2[..., 0]
    begin = (first[..., :2] - vertices).astype(float)
    ahead = (second[..., :2] - vertices).astype(float) - begin
    fraction = (ahead[..., 0] * d2[..., 1] - ahead[..., 1] * d2[..., 0]) / np.where(turn == 0.0, np.inf, turn)
    crossing = begin + fraction[..., None] * d1
    is_near = (turn != 0.0) & (np.abs(crossing).max(axis=-1) <= _NEAR_MM)
    return np.where(is_near[..., None], vertices + crossing, vertices)
