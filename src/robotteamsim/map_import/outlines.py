"""Converts solid cells to outlines, with straight lines where cells form staircases."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
import shapely

from robotteamsim.map_import.straight_lines import best_runs, fitted_line, foot, meeting_point
from robotteamsim.map_import.thickness import edge_thickness

LONG_EDGE_CELLS = 16.0
"""An edge along an axis of at least this length is the face of a wall and stays; shorter ones may be a staircase."""

SMALL_RING_CELLS = 16.0
"""A ring up to this length keeps all its edges."""

_LINE_PRICE = 3.0
"""Penalty of one more straight line in squared distances along the border [cells^3]. It is larger for long steps,
because a step of n cells has n / 12, and smaller in short chains, so that small details keep their sides."""

_CHAMFER_CELLS = 3.0
"""A side up to this length is removed if its neighbours meet."""

_MAX_DISTANCE_CELLS = 1.25
"""Largest distance of a corner of the cells' border from the line of its side; in a staircase it is below 0.71."""

_KINK_CELLS = 0.25
"""Corners within this distance of the line through their neighbours are removed."""

_THICK_CELLS = 4.0
"""A wall at least this thick allows any staircase to be moved inwards as far as needed."""

_CROSSING_CELLS = 2.0
"""Where sides cross, the cells' borders are restored within this distance, which is doubled until no sides cross."""

_MEETING_CELLS = 1.0
"""Two sides meet at the intersection of their lines if it is within this distance of the cells' border."""


def outlines(solid: np.ndarray) -> list[shapely.Polygon]:
    """Return the outlines of solid cells, in cells; holes are kept, and all polygons are valid.

    Edges along the axes stay on the cells' borders. A staircase becomes the line whose drawing, as all cells that it
    touches, is that staircase: the best line through the steps, moved inwards by half the band that they fill. It is
    moved less where the wall would become thinner than a cell.

    Args: solid: bool, shape (rows, cols), row 0 at the lowest y; no two cells touch only at a corner.
    """
    # cv2.findContours goes through the centres of cells instead of along their borders.
    edges = np.diff(np.pad(solid, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    rows, first = np.nonzero(edges == 1)
    last = np.nonzero(edges == -1)[1]
    exact = shapely.union_all(shapely.box(first, rows, last, rows + 1))
    return [_straightened(polygon) for polygon in shapely.get_parts(exact)]


def _straightened(polygon: shapely.Polygon) -> shapely.Polygon:
    """Return a polygon along cell borders with straight lines for its staircases."""
    exact = shapely.orient_polygons(shapely.simplify(polygon, 0.0))
    rings = [_Ring(shapely.get_coordinates(ring)[:-1]) for ring in (exact.exterior, *exact.interiors)]
    thickness = edge_thickness(_without_crossings(rings), _THICK_CELLS)
    for ring in rings:
        of_ring, thickness = np.split(thickness, [len(ring.points)])
        ring.move_in(of_ring)
    return shapely.simplify(_without_crossings(rings), _KINK_CELLS)


def _without_crossings(rings: Sequence[_Ring]) -> shapely.Polygon:
    """Return the polygon of some rings; where sides cross, the cells' borders are restored."""
    near = _CROSSING_CELLS
    while True:
        shell, *holes = (ring.points for ring in rings)
        polygon = shapely.Polygon(shell, holes)
        if polygon.is_valid:
            return polygon
        places = _crossings(rings)
        restored = [ring.restore(at, near) for ring, at in zip(rings, places, strict=True)]
        near = _CROSSING_CELLS if any(restored) else 2.0 * near
        assert near < 1e9, "the borders of cells that touch only at a corner do not form a polygon"


def _crossings(rings: Sequence[_Ring]) -> list[list[np.ndarray]]:
    """Return per ring the places where edges touch edges that are not neighbours, or run back along a neighbour."""
    sizes = [len(ring.points) for ring in rings]
    starts = np.concatenate([ring.points for ring in rings])
    ends = np.concatenate([np.roll(ring.points, -1, axis=0) for ring in rings])
    segments = shapely.linestrings(np.stack([starts, ends], axis=1))
    ring_of = np.repeat(np.arange(len(rings)), sizes).tolist()
    edge_of = np.concatenate([np.arange(size) for size in sizes]).tolist()
    places: list[list[np.ndarray]] = [[] for _ in rings]
    for i, j in shapely.STRtree(segments).query(segments, predicate="intersects").T.tolist():
        size = sizes[ring_of[i]]
        neighbours = ring_of[i] == ring_of[j] and (edge_of[j] - edge_of[i]) % size in (1, size - 1)
        common = segments[i].intersection(segments[j])
        if i != j and (not neighbours or common.length > 0.0):
            places[ring_of[i]] += list(shapely.get_coordinates(common))
    return places


class _Ring:
    """One ring along cell borders, cut into runs of edges that each represent one straight side.

    points: the ring as it is now, float64, shape (n, 2), the solid on its left.
    """

    def __init__(self, corners: np.ndarray) -> None:
        edges = np.roll(corners, -1, axis=0) - corners
        faces = np.flatnonzero(_are_faces(edges))
        # A ring starts with a face, or else with a corner, such as the outermost point.
        far = np.hypot(*(corners - corners.mean(axis=0)).T).round(6)
        first = int(faces[0]) if len(faces) else int(np.argmax(far))
        self._corners, edges = np.roll(corners, -first, axis=0), np.roll(edges, -first, axis=0)
        self._edges = shapely.linestrings(np.stack([self._corners, self._corners + edges], axis=1))
        self._border = shapely.LinearRing(corners)
        shapely.prepare(self._border)
        self._runs = _sides(self._corners, edges, (faces - first).tolist())
        self._lines = [fitted_line(self._corners[start:end], edges[start:end]) for start, end in self._runs]
        self._leave_out_chamfers()
        self._as_cells = np.zeros(len(corners), dtype=bool)
        self._trace()

    def restore(self, places: Sequence[np.ndarray], near: float) -> bool:
        """Restore the cells' borders near some places. Returns: False if they were already restored."""
        before = np.count_nonzero(self._as_cells)
        for place in places:
            self._as_cells |= shapely.distance(self._edges, shapely.Point(place)) <= near
        self._trace()
        return bool(np.count_nonzero(self._as_cells) > before)

    def move_in(self, thickness: np.ndarray) -> None:
        """Move slanted sides inwards to the line that was drawn, but keep a thickness of one cell.

        Args: thickness: of the wall behind each edge, float64, shape (len(points),).
        """
        for side, (middle, direction) in enumerate(self._lines):
            behind = thickness[self._side_of_edge == side]
            if len(behind) and abs(direction).min() > 0.0:
                move = min(0.5 * abs(direction).sum(), max(0.5 * (behind.min() - 1.0), 0.0))
                self._lines[side] = (middle + move * np.array([-direction[1], direction[0]]), direction)
        self._trace()

    def _trace(self) -> None:
        """Join the sides to a ring."""
        stretches = self._stretches()
        points: list[np.ndarray] = []
        sides: list[int] = []
        for i, (side, start, end) in enumerate(stretches):
            here = self._joint(stretches[i - 1], stretches[i])
            if self._as_cells[start]:
                here += list(self._corners[start + 1 : end])
            points += here
            sides += [-1 if self._as_cells[start] else side] * len(here)
        ring = np.array(points)
        apart = np.any(np.abs(ring - np.roll(ring, -1, axis=0)) > 1e-6, axis=1)
        if np.count_nonzero(apart) < 3:
            self._as_cells[:] = True
            ring, sides, apart = self._corners, [-1] * len(self._corners), np.full(len(self._corners), True)
        self.points, self._side_of_edge = ring[apart], np.array(sides)[apart]

    def _stretches(self) -> list[tuple[int, int, int]]:
        """Return side, first edge and last + 1 of each section that is only a line, or only borders of cells."""
        changes = np.flatnonzero(self._as_cells[1:] != self._as_cells[:-1]) + 1
        stretches = []
        for side, (start, end) in enumerate(self._runs):
            inner = changes[np.searchsorted(changes, start, "right") : np.searchsorted(changes, end, "left")].tolist()
            stretches += [(side, a, b) for a, b in itertools.pairwise([start, *inner, end])]
        return stretches

    def _joint(self, before: tuple[int, int, int], this: tuple[int, int, int]) -> list[np.ndarray]:
        """Return the points where one section ends and the next starts: one if they meet, else two."""
        corner = self._corners[this[1]]
        one, other = (None if self._as_cells[start] else side for side, start, _ in (before, this))
        if one is None or other is None:
            leave = [] if one is None else [foot(corner, self._lines[one])]
            return [*leave, corner] if other is None else [*leave, corner, foot(corner, self._lines[other])]
        meeting = self._meeting(one, other, corner)
        return [foot(corner, self._lines[one]), foot(corner, self._lines[other])] if meeting is None else [meeting]

    def _leave_out_chamfers(self) -> None:
        """Merge short sides into the previous side if the previous and the next side meet nearby."""
        side = 1
        while side < len(self._runs) and len(self._runs) > 3:
            before, after = side - 1, (side + 1) % len(self._runs)
            shorter = self._length(side) <= min(_CHAMFER_CELLS, self._length(before), self._length(after))
            if shorter and self._meeting(before, after, self._corners[self._runs[side][0]]) is not None:
                self._runs[before] = (self._runs[before][0], self._runs[side][1])
                del self._runs[side], self._lines[side]
            else:
                side += 1

    def _meeting(self, one: int, other: int, corner: np.ndarray) -> np.ndarray | None:
        """Return the intersection of two sides if it is close to a corner of the border and to the border itself."""
        meeting = meeting_point(self._lines[one], self._lines[other])
        reach = max(3.0, 0.5 * min(self._length(one), self._length(other)))
        if meeting is None or np.hypot(*(meeting - corner)) > reach:
            return None
        return meeting if self._border.distance(shapely.Point(meeting)) < _MEETING_CELLS else None

    def _length(self, side: int) -> float:
        start, end = self._runs[side]
        return float(np.hypot(*(self._corners[end % len(self._corners)] - self._corners[start])))


def _sides(corners: np.ndarray, edges: np.ndarray, faces: list[int]) -> list[tuple[int, int]]:
    """Return the runs of edges, first and last + 1, that form one side each; a face is a side of its own."""
    lengths = np.abs(edges).sum(axis=1)
    if lengths.sum() <= SMALL_RING_CELLS:
        return [(edge, edge + 1) for edge in range(len(edges))]
    runs = [(face, face + 1) for face in faces]
    for start, end in zip([face + 1 for face in faces] or [0], [*faces[1:], len(edges)], strict=True):
        if end > start:
            longest, whole = lengths[start:end].max(), lengths[start:end].sum()
            price = min(max(_LINE_PRICE, longest / 10.0), whole / 32.0)
            for a, b in best_runs(corners[start:end], edges[start:end], price):
                runs += _within_distance(corners, edges, start + a, start + b)
    return sorted(runs)


def _within_distance(corners: np.ndarray, edges: np.ndarray, start: int, end: int) -> list[tuple[int, int]]:
    """Split a run of edges at its farthest corners until none is too far from the line."""
    point, (x, y) = fitted_line(corners[start:end], edges[start:end])
    reached = np.vstack([corners[start:end], corners[end - 1] + edges[end - 1]]) - point
    distances = np.abs(reached[:, 0] * y - reached[:, 1] * x)
    if end - start == 1 or distances.max() <= _MAX_DISTANCE_CELLS:
        return [(start, end)]
    middle = start + 1 + int(np.argmax(distances[1:-1]))
    return [*_within_distance(corners, edges, start, middle), *_within_distance(corners, edges, middle, end)]


def _are_faces(edges: np.ndarray) -> np.ndarray:
    """Return which edges are long and not part of a line with a small slope.

    Such a line has steps of one cell, all up or all down, between runs of similar length.
    """
    lengths, before = np.abs(edges).sum(axis=1), np.roll(edges, 1, axis=0)
    turns = np.sign(before[:, 0] * edges[:, 1] - before[:, 1] * edges[:, 0])
    climbs = turns != np.roll(turns, -1)
    step_before, step_after = np.roll(lengths, 1) == 1.0, np.roll(lengths, -1) == 1.0
    limit = 1.25 * lengths + 1.0
    similar = (np.roll(lengths, 2) <= limit) | (np.roll(lengths, -2) <= limit)
    inner = climbs & step_before & step_after & similar
    first = np.roll(inner, -2) & step_after & (lengths <= np.roll(limit, -2))
    last = np.roll(inner, 2) & step_before & (lengths <= np.roll(limit, 2))
    faces: np.ndarray = (lengths >= LONG_EDGE_CELLS) & ~(inner | first | last)
    return faces
