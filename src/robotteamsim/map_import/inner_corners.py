"""Cuts a polygon of walls where walls meet: from each inner corner straight to the nearest opposite side."""

import itertools
import math
from dataclasses import dataclass

import numpy as np
import shapely

_BEND = 0.2
"""Sine of the smallest turn that counts as an inner corner; a smaller turn is a slight bend of one wall."""

_SLACK = 0.05
"""Sine by which a cut may deviate from the directions that leave no inner corner on either side of it."""

_SAME_POINT = 0.5
"""A cut that would end within this distance of a corner ends at the corner; no cut is shorter."""


def cut_at_inner_corners(polygon: shapely.Polygon, longest: float) -> list[shapely.Polygon]:
    """Return the parts of a polygon after cutting it at its inner corners, which separates walls that meet.

    A cut goes from an inner corner to the nearest point of the outline that leaves no inner corner on either side.
    Corners where that is farther than `longest`, or where a shorter cut is in the way, are not cut.
    """
    outline = _Outline(shapely.orient_polygons(polygon))
    cuts = _compatible(sorted(outline.cuts(longest), key=lambda cut: cut.length))
    if not cuts:
        return [polygon]
    faces = shapely.get_parts(shapely.polygonize(outline.segments(cuts)))
    parts = [face for face in faces if shapely.contains(polygon, face.representative_point())]
    # Rounding may keep cuts from meeting the outline; then nothing is cut.
    whole = math.isclose(sum(part.area for part in parts), polygon.area, rel_tol=1e-9)
    return parts if whole else [polygon]


@dataclass(frozen=True, slots=True, eq=False)
class _Cut:
    """A segment from an inner corner to another corner, or to a point on an edge."""

    start: np.ndarray
    end: np.ndarray
    start_corner: int
    end_corner: int | None
    end_edge: int | None

    @property
    def length(self) -> float:
        return float(np.hypot(*(self.end - self.start)))


def _compatible(cuts: list[_Cut]) -> list[_Cut]:
    """Return the cuts that no earlier one crosses; of two cuts between the same corners the first."""
    segments = shapely.linestrings(np.array([[cut.start, cut.end] for cut in cuts]).reshape(-1, 2, 2))
    meets: list[set[int]] = [set() for _ in cuts]
    for i, j in shapely.STRtree(segments).query(segments, predicate="intersects").T.tolist():
        meets[i].add(j)
    kept: set[int] = set()
    for i, cut in enumerate(cuts):
        others = [cuts[j] for j in meets[i] & kept]
        reached = any(other.end_corner == cut.start_corner for other in others)
        corners = {cut.start_corner, cut.end_corner} - {None}
        if not reached and all(corners & {other.start_corner, other.end_corner} for other in others):
            kept.add(i)
    return [cut for i, cut in enumerate(cuts) if i in kept]


class _Outline:
    """Corners and edges of a polygon, the solid on the left; edge i leads from corner i to corner `_following[i]`."""

    def __init__(self, polygon: shapely.Polygon) -> None:
        rings = [shapely.get_coordinates(ring)[:-1] for ring in (polygon.exterior, *polygon.interiors)]
        indices = np.split(np.arange(sum(map(len, rings))), np.cumsum([len(ring) for ring in rings[:-1]]))
        self._corners = np.concatenate(rings)
        self._following = np.concatenate([np.roll(index, -1) for index in indices])
        self._preceding = np.concatenate([np.roll(index, 1) for index in indices])
        along = self._corners[self._following] - self._corners
        self._lengths = np.hypot(*along.T)
        self._directions = along / self._lengths[:, None]
        self._polygon = polygon
        shapely.prepare(self._polygon)
        ends = np.stack([self._corners, self._corners[self._following]], axis=1)
        self._tree = shapely.STRtree(shapely.linestrings(ends))

    def cuts(self, longest: float) -> list[_Cut]:
        """Return the shortest cut of each inner corner that has one."""
        into, out = self._directions[self._preceding], self._directions
        turns, ahead = into[:, 0] * out[:, 1] - into[:, 1] * out[:, 0], np.sum(into * out, axis=1)
        inner = np.flatnonzero((turns < -_BEND) | ((turns < 0.0) & (ahead < 0.0)))
        found = (self._shortest(corner, longest) for corner in inner.tolist())
        return [cut for cut in found if cut is not None]

    def segments(self, cuts: list[_Cut]) -> np.ndarray:
        """Return the edges, split where cuts end, and the cuts: lines that meet only at their ends."""
        feet: dict[int, list[np.ndarray]] = {}
        for cut in cuts:
            if cut.end_edge is not None:
                feet.setdefault(cut.end_edge, []).append(cut.end)
        lines = [(cut.start, cut.end) for cut in cuts]
        for edge, start in enumerate(self._corners):
            inner = sorted(feet.get(edge, []), key=lambda foot: float((foot - start) @ self._directions[edge]))
            lines += itertools.pairwise([start, *inner, self._corners[self._following[edge]]])
        segments: np.ndarray = shapely.linestrings(np.array(lines))
        return segments

    def _shortest(self, corner: int, longest: float) -> _Cut | None:
        here = self._corners[corner]
        near = self._tree.query(shapely.Point(here), predicate="dwithin", distance=longest).tolist()
        candidates = [_Cut(here, self._corners[end], corner, end, None) for end in near if end != corner]
        candidates += [cut for edge in near for cut in self._to_edge(corner, edge)]
        candidates = [cut for cut in candidates if _SAME_POINT < cut.length <= longest]
        in_order = sorted(candidates, key=lambda cut: cut.length)
        return next((cut for cut in in_order if self._halves(cut) and self._is_inside(cut)), None)

    def _to_edge(self, corner: int, edge: int) -> list[_Cut]:
        """Return the perpendicular cut from a corner to an edge; none if its foot is beyond the edge's ends."""
        start, direction = self._corners[edge], self._directions[edge]
        place = float((self._corners[corner] - start) @ direction)
        if not _SAME_POINT < place < self._lengths[edge] - _SAME_POINT:
            return []
        return [_Cut(self._corners[corner], start + place * direction, corner, None, edge)]

    def _halves(self, cut: _Cut) -> bool:
        """Whether the cut leaves no inner corner on either side of its start."""
        direction = (cut.end - cut.start) / cut.length
        into, out = self._directions[self._preceding[cut.start_corner]], self._directions[cut.start_corner]
        return _sine(into, direction) >= -_SLACK and _sine(out, direction) >= -_SLACK

    def _is_inside(self, cut: _Cut) -> bool:
        inset = 1e-3 * (cut.end - cut.start)
        return bool(shapely.contains(self._polygon, shapely.LineString([cut.start + inset, cut.end - inset])))


def _sine(a: np.ndarray, b: np.ndarray) -> float:
    return float(a[0] * b[1] - a[1] * b[0])
