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

_LEAST_END = 0.25
"""An end of a gap stands out from a wall by this share of the least width; a corridor's narrowest place does not."""

_LEAST_JAMB = 0.6
"""Least share of the cells at either end of a gap that are solid."""


_LEAST_WIDER = 1.3
"""The inside of a building is so many times as wide as a gap in its outer wall."""

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


def thin_strokes(ink: np.ndarray, thinnest_cells: float) -> np.ndarray:
    """Return which cells of ink belong to strokes that are thinner than a width in cells, bool, same shape.

    A cell belongs to a wall if it is within that width of a place where a square of that width fits into the ink: ends
    and corners of walls stay, and what a thin line that meets a wall leaves is no longer than that.
    """
    import cv2

    size = round(min(thinnest_cells, max(ink.shape) + 1))
    if size <= 1:
        return np.zeros(ink.shape, dtype=bool)
    window = np.ones((size, size), np.uint8)
    core = cv2.morphologyEx(ink.astype(np.uint8), cv2.MORPH_OPEN, window)
    near = cv2.dilate(core, np.ones((size | 1, size | 1), np.uint8)).astype(bool)
    thin: np.ndarray = ink & ~near
    return thin


def small_groups(ink: np.ndarray, smallest_cells: float) -> np.ndarray:
    """Return which cells of ink belong to connected groups that are smaller than that in width and height: letters."""
    import cv2

    smallest_cells = round(min(smallest_cells, max(ink.shape) + 1))
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


def outside(solid: np.ndarray, width_cells: float) -> np.ndarray:
    """Return the floor around a building, bool, same shape: what a disc of that width reaches from the border.

    The outermost cells count as floor, because an import closes them.
    """
    import cv2

    radius = 0.5 * width_cells
    margin = math.ceil(radius) + 2
    floor = np.pad(~solid, margin, constant_values=True)
    floor[[margin, -margin - 1]] = floor[:, [margin, -margin - 1]] = True
    fits = cv2.distanceTransform(floor.astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE) > radius
    _, labels = cv2.connectedComponents(fits.astype(np.uint8), connectivity=4)
    away = cv2.distanceTransform((labels != labels[0, 0]).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    inner = slice(margin, -margin)
    reached: np.ndarray = (floor & (away <= radius))[inner, inner]
    return reached


def exits(solid: np.ndarray, width_cells: float, robot_cells: float, least_cells: float) -> np.ndarray | None:
    """Return where a robot can leave the inside, of at least that many cells; float64, shape (n, 2), column and row.

    None: there is no inside.

    Args: width_cells: of the disc that defines the `outside`.  robot_cells: the robot's radius.
    """
    import cv2

    around = outside(solid, width_cells)
    clear = cv2.distanceTransform((~solid).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    fits = clear > robot_cells
    _, labels, statistics, _ = cv2.connectedComponentsWithStats((fits & ~around).astype(np.uint8), connectivity=4)
    labels[statistics[labels, cv2.CC_STAT_AREA] < least_cells] = 0
    inside = labels > 0
    if not inside.any():
        return None
    widest = np.zeros(len(statistics))
    np.maximum.at(widest, labels[inside], clear[inside])
    next_to = cv2.dilate(labels.astype(np.float32), np.ones((3, 3), np.uint8)).astype(int)
    edge = (next_to > 0) & around & fits
    count, edges, _, middles = cv2.connectedComponentsWithStats(edge.astype(np.uint8), connectivity=8)
    widths, behind = np.zeros(count), np.zeros(count)
    np.maximum.at(widths, edges[edge], clear[edge])
    np.maximum.at(behind, edges[edge], widest[next_to[edge]])
    is_gap = behind > _LEAST_WIDER * widths  # else it is a passage between buildings
    is_gap[0] = False
    places: np.ndarray = middles[is_gap]
    return places


def outer_gaps(solid: np.ndarray, sizes: GapSizes) -> list[Gap]:
    """Return the gaps between the inside of a building and its outside, see `gaps` and `outside`."""
    around = outside(solid, 2.0 * sizes.most)
    found = []
    for gap in gaps(solid, sizes):
        cells, at = (around, gap) if gap.along_x else (around.T, Gap(gap.row, gap.column, gap.rows, gap.columns, True))
        columns = slice(at.column, at.column + at.columns)
        if (cells[at.row - 1, columns].mean() > 0.5) != (cells[at.row + at.rows, columns].mean() > 0.5):
            found.append(gap)
    return found


def _gaps_along_x(solid: np.ndarray, sizes: GapSizes) -> list[Gap]:
    import cv2

    cells = np.ascontiguousarray(solid, dtype=np.uint8)
    _, labels, statistics, _ = cv2.connectedComponentsWithStats(cells, connectivity=8)
    along, across = statistics[:, cv2.CC_STAT_WIDTH], statistics[:, cv2.CC_STAT_HEIGHT]
    is_strip = (along >= _LEAST_STRIP * across) & (along >= _SHORTEST_STRIP * sizes.loose)
    is_loose = (np.maximum(along, across) < sizes.loose) & ~is_strip
    lengths = _short_runs(solid, min(sizes.most, solid.shape[1]))
    _, groups, places, _ = cv2.connectedComponentsWithStats((lengths > 0).astype(np.uint8), connectivity=4)
    found: list[Gap] = []
    for group, (column, row, columns, rows, _) in enumerate(places[1:].tolist(), 1):
        window = np.s_[row : row + rows, column : column + columns]
        own = np.where(groups[window] == group, lengths[window], 0)
        for gap in _gaps_among(own, cells, (column, row), sizes):
            if gap.column <= 1 or gap.column + gap.columns >= solid.shape[1] - 1:
                continue  # an end is the border of the image, which is no wall that was drawn
            beside = slice(gap.row, gap.row + gap.rows)
            ends = labels[beside, gap.column - 1], labels[beside, gap.column + gap.columns]
            if not any(is_loose[end[end > 0]].any() for end in ends):
                found.append(gap)
    return found


def _short_runs(solid: np.ndarray, most_cells: float) -> np.ndarray:
    """Return for each cell the length of the run along x between two solid cells; 0: longer, or none; int32."""
    padded = np.pad(solid, ((0, 0), (1, 1)), constant_values=True).astype(np.int8)
    changes = np.diff(padded, axis=1)
    begin_rows, begins = np.nonzero(changes == -1)
    _, ends = np.nonzero(changes == 1)
    lengths = ends - begins
    is_short = (lengths <= most_cells) & (begins > 0) & (ends < solid.shape[1])
    steps = np.zeros((solid.shape[0], solid.shape[1] + 1), dtype=np.int32)
    steps[begin_rows[is_short], begins[is_short]] = lengths[is_short]
    steps[begin_rows[is_short], ends[is_short]] = -lengths[is_short]
    runs: np.ndarray = np.cumsum(steps, axis=1)[:, :-1]
    return runs


def _gaps_among(lengths: np.ndarray, cells: np.ndarray, corner: tuple[int, int], sizes: GapSizes) -> Iterator[Gap]:
    """Yield the gaps along x of each width. Args: lengths: of connected short runs, from a corner of the cells on."""
    import cv2

    most = min(sizes.most, lengths.shape[1])
    for width_cells in range(math.ceil(min(sizes.least, most + 1)), math.floor(most) + 1):
        narrower = ((lengths > 0) & (lengths <= width_cells)).astype(np.uint8)
        _, _, statistics, _ = cv2.connectedComponentsWithStats(narrower, connectivity=4)
        for x, y, width, depth, area in statistics[1:].tolist():
            gap = Gap(corner[0] + x, corner[1] + y, width, depth, along_x=True)
            is_clear = width == width_cells and area >= _LEAST_CLEAR * width * depth
            if (
                is_clear
                and depth <= sizes.deepest
                and _is_in_a_wall(gap, cells, max(round(_LEAST_END * sizes.least), 1))
            ):
                yield gap


def _is_in_a_wall(gap: Gap, cells: np.ndarray, reach: int) -> bool:
    """Whether a gap along x has solid ends, is open on both sides, and one of its ends stands out from a wall.

    Args: reach: so far beside the gap, the cells past an end that stands out are open.
    """
    left, right, low, top = gap.column, gap.column + gap.columns, gap.row, gap.row + gap.rows
    if low == 0 or top == len(cells):
        return False
    jambs = min(cells[low:top, left - 1].mean(), cells[low:top, right].mean())
    beside = max(cells[low - 1, left:right].mean(), cells[top, left:right].mean())
    # Two cells away, because ends that are drawn by hand are round.
    sides = max(low - 3, 0), min(top + 2, len(cells) - 1)
    ends = slice(max(left - reach, 0), left), slice(right, right + reach)
    past = min(cells[side, end].mean() for side in sides for end in ends)
    return bool(jambs >= _LEAST_JAMB and max(beside, past) <= 1.0 - _LEAST_OPEN)
