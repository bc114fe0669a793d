"""The thickness of walls, from their outlines."""

from collections.abc import Sequence

import numpy as np
import shapely

_INSET = 1e-3
_MAX_SAMPLES = 200
"""Per edge; on longer edges they are farther apart."""


def piece_thickness(polygon: shapely.Polygon, pieces: Sequence[np.ndarray], most: float) -> np.ndarray:
    """Return the thickness of the wall that each piece of a polygon is part of; NaN if a piece has no outer face.

    It is the median along the piece's part of the outline.

    Args:    pieces: corners of each, float64, shape (n, 2).
             most: thicker walls count as this.
    Returns: float64, shape (len(pieces),).
    """
    samples = _Samples(polygon, most)
    tree = shapely.STRtree([shapely.Polygon(piece) for piece in pieces])
    sample, home = tree.query(shapely.points(samples.inside), predicate="intersects")
    return _medians(samples.thickness[sample], samples.weights[sample], home, len(pieces))


def edge_thickness(polygon: shapely.Polygon, most: float) -> np.ndarray:
    """Return the median thickness of the wall behind each edge of a polygon, shell first; float64, shape (edges,)."""
    samples = _Samples(polygon, most)
    return _medians(samples.thickness, samples.weights, samples.edge, samples.num_edges)


class _Samples:
    """Points spread evenly along the outline of a polygon, and the thickness of the wall behind each.

    The thickness at a point of a face is the shorter of two lengths through the solid: straight to the far side, and
    across that line at its middle. The end of a wall therefore gives the same thickness as its long faces.
    """

    def __init__(self, polygon: shapely.Polygon, most: float) -> None:
        oriented = shapely.orient_polygons(polygon)
        rings = [shapely.get_coordinates(ring) for ring in (oriented.exterior, *oriented.interiors)]
        starts, ends = np.concatenate([ring[:-1] for ring in rings]), np.concatenate([ring[1:] for ring in rings])
        lengths = np.hypot(*(ends - starts).T)
        counts = np.clip(np.ceil(lengths), 1, _MAX_SAMPLES).astype(int)
        self.num_edges = len(starts)
        self.edge = np.repeat(np.arange(len(starts)), counts)
        self.weights = (lengths / counts)[self.edge]
        place = (np.arange(len(self.edge)) - np.repeat(np.cumsum(counts) - counts, counts) + 0.5) * self.weights
        along = ((ends - starts) / lengths[:, None])[self.edge]
        inward = np.stack([-along[:, 1], along[:, 0]], axis=1)
        self.inside = starts[self.edge] + place[:, None] * along + _INSET * inward
        rays = _Rays(starts, ends, most)
        straight_in = rays.lengths(self.inside, inward)
        middle = self.inside + 0.5 * straight_in[:, None] * inward
        self.thickness = np.minimum(straight_in, rays.lengths(middle, along) + rays.lengths(middle, -along))


class _Rays:
    """Straight lines from points to the nearest edge."""

    def __init__(self, starts: np.ndarray, ends: np.ndarray, most: float) -> None:
        self._starts, self._edges, self._most = starts, ends - starts, most
        self._tree = shapely.STRtree(shapely.linestrings(np.stack([starts, ends], axis=1)))

    def lengths(self, points: np.ndarray, directions: np.ndarray) -> np.ndarray:
        rays = shapely.linestrings(np.stack([points, points + self._most * directions], axis=1))
        ray, edge = self._tree.query(rays, predicate="intersects")
        d, e, gap = directions[ray], self._edges[edge], self._starts[edge] - points[ray]
        sine = d[:, 0] * e[:, 1] - d[:, 1] * e[:, 0]
        meets = np.abs(sine) > 1e-9 * np.hypot(*e.T)
        lengths = (gap[meets, 0] * e[meets, 1] - gap[meets, 1] * e[meets, 0]) / sine[meets]
        shortest = np.full(len(points), self._most)
        np.minimum.at(shortest, ray[meets], np.maximum(lengths, 0.0))
        return shortest


def _medians(values: np.ndarray, weights: np.ndarray, groups: np.ndarray, count: int) -> np.ndarray:
    """Return the weighted median of each group; NaN for a group without values."""
    order = np.lexsort((values, groups))
    values, weights, groups = values[order], weights[order], groups[order]
    total = np.concatenate([[0.0], np.cumsum(weights)])
    first, last = np.searchsorted(groups, np.arange(count)), np.searchsorted(groups, np.arange(count), side="right")
    middle = np.searchsorted(total, 0.5 * (total[first] + total[last])) - 1
    result = np.full(count, np.nan)
    filled = last > first
    result[filled] = values[np.clip(middle[filled], first[filled], last[filled] - 1)]
    return result
