"""Separates walls from what else a drawing shows: text, dimension lines, door arcs; finds the gaps between walls.

OpenCV is imported where it is used, because it belongs to an extra.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

_LEAST_OPEN = 0.7
"""Least share of the cells beside a gap that are not solid."""

_LEAST_CLEAR = 0.9
"""Least share of the cells of a gap that are not solid."""

_LEAST_JAMB = 0.6
"""Least share of the cells at either end of a gap that are solid."""


_LEAST_STRIP = 2.0
"""A loose object at least so many times as long as it is wide is a piece of wall, if it is not short."""

_SHORTEST_STRIP = 0.2
"""Its least length, as a share of the size below which objects are loose: longer than a letter."""


class Gap(NamedTuple):
    """A gap in a wall along an axis, in cells: its lower left corner, width and depth; `along_x`: the wall's axis."""

    column: int
    row: int
    columns: int
    rows: int
    along_x: bool

    def meets(self, other: Gap) -> bool:
        """Whether two gaps overlap or touch."""
        apart_x = self.column > other.column + other.columns or other.column > self.column + self.columns
        apart_y = self.row > other.row + other.rows or other.row > self.row + self.rows
        return not (apart_x or apart_y)


def thin_strokes(ink: np.ndarray, thinnest_cells: int) -> np.ndarray:
    """Return which cells of ink belong to strokes that are thinner than a width in cells, bool, same shape.

    A cell belongs to a wall if it is within that width of a place where a square of that width fits into the ink: ends
    and corners of walls stay, and what a thin line that meets a wall leaves is no longer than that.
    """
    import cv2

    if thinnest_cells <= 1:
        return np.zeros(ink.shape, dtype=bool)
    window = np.ones((thinnest_cells, thinnest_cells), np.uint8)
    core = cv2.morphologyEx(ink.astype(np.uint8), cv2.MORPH_OPEN, window)
    near = cv2.dilate(core, np.ones((thinnest_cells | 1, thinnest_cells | 1), np.uint8)).astype(bool)
    thin: np.ndarray = ink & ~near
    return thin


def small_groups(ink: np.ndarray, smallest_cells: int) -> np.ndarray:
    """Return which cells of ink belong to connected groups that are smaller than that in width and height: letters."""
    import cv2

    if smallest_cells <= 1:
        return np.zeros(ink.shape, dtype=bool)
    _, labels, statistics, _ = cv2.connectedComponentsWithStats(ink.astype(np.uint8), connectivity=8)
    size = statistics[:, [cv2.CC_STAT_WIDTH, cv2.CC_STAT_HEIGHT]].max(axis=1)
    small: np.ndarray = ink & (size < smallest_cells)[labels]
    return small


class GapSizes(NamedTuple):
    """Sizes in cells: least and greatest width of a gap, greatest depth of a wall, greatest size of a loose object."""

    least: float
    most: float
    deepest: float
    loose: float


def gaps(solid: np.ndarray, sizes: GapSizes) -> list[Gap]:
    """Return the gaps in walls along the axes, from the lowest row up.

    A gap is a rectangle that is not solid between two solid ends, open on its other sides, and no deeper than a wall.
    Its ends are not of loose objects, such as letters, pillars and tables; a loose strip along the axis is a wall
    between two gaps. Each width is searched by itself: wider ones would also fill the corridor that a narrow gap leads
    to. Where ends are ragged, several widths find one gap: of those that meet, the largest is kept.

    Args: solid: bool, row 0 at the lowest y.
    """
    turned = _gaps_along_x(solid.T, sizes)
    upright = [Gap(gap.row, gap.column, gap.rows, gap.columns, along_x=False) for gap in turned]
    found = sorted([*_gaps_along_x(solid, sizes), *upright], key=lambda gap: (-gap.columns * gap.rows, gap))
    kept: list[Gap] = []
    for gap in found:
        if not any(gap.meets(other) for other in kept):
            kept.append(gap)
    return sorted(kept, key=lambda gap: (gap.row, gap.column))


def _gaps_along_x(solid: np.ndarray, sizes: GapSizes) -> list[Gap]:
    import cv2

    cells = np.ascontiguousarray(solid, dtype=np.uint8)
    _, labels, statistics, _ = cv2.connectedComponentsWithStats(cells, connectivity=8)
    along, across = statistics[:, cv2.CC_STAT_WIDTH], statistics[:, cv2.CC_STAT_HEIGHT]
    is_strip = (along >= _LEAST_STRIP * across) & (along >= _SHORTEST_STRIP * sizes.loose)
    is_loose = (np.maximum(along, across) < sizes.loose) & ~is_strip
    found: dict[Gap, None] = {}
    most = min(sizes.most, solid.shape[1])
    for width in range(math.ceil(min(sizes.least, most + 1)), math.floor(most) + 1):
        for gap in _gaps_of_width(cells, width, sizes.deepest):
            rows, right = slice(gap.row, gap.row + gap.rows), gap.column + gap.columns
            ends = labels[rows, gap.column - 1], labels[rows, right]
            if not any(is_loose[end[end > 0]].any() for end in ends):
                found[gap] = None
    return list(found)


def _gaps_of_width(cells: np.ndarray, width_cells: int, deepest_cells: float) -> Iterator[Gap]:
    """Yield the gaps along x of one width. Args: cells: which are solid, uint8."""
    import cv2

    closed = cv2.morphologyEx(cells, cv2.MORPH_CLOSE, np.ones((1, width_cells + 1), np.uint8))
    filled = (closed > cells).astype(np.uint8)
    _, _, statistics, _ = cv2.connectedComponentsWithStats(filled, connectivity=4)
    rows, columns = cells.shape
    for column, row, width, depth, area in statistics[1:].tolist():
        right, top = column + width, row + depth
        if width != width_cells or area < _LEAST_CLEAR * width * depth:
            continue
        if depth > deepest_cells or column == 0 or row == 0 or right == columns or top == rows:
            continue
        jambs = min(cells[row:top, column - 1].mean(), cells[row:top, right].mean())
        beside = max(cells[row - 1, column:right].mean(), cells[top, column:right].mean())
        if jambs >= _LEAST_JAMB and beside <= 1.0 - _LEAST_OPEN:
            yield Gap(column, row, width, depth, along_x=True)
