"""Solid cells of an image as walls and blocks: thin axis-aligned rectangles are walls, all other pieces blocks."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

import numpy as np
import shapely

from robotteamsim.map_import.convex_pieces import convex_pieces
from robotteamsim.map_import.inner_corners import cut_at_inner_corners
from robotteamsim.map_import.outlines import outlines
from robotteamsim.map_import.thickness import piece_thickness
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.floor_plan import Block, Wall
from robotteamsim.scenario.plan import Corners

MAX_WALL_THICKNESS_M = 0.8
"""Last limit of the loss table: a thicker rectangle is a block."""

THICKEST_M = 1.0
"""Thicker walls count as this: the loss table does not distinguish them."""

MIN_PIECE_M2 = 1e-6
"""Smaller pieces are omitted."""


def walls_and_blocks(solid: np.ndarray, low_m: Point, cell_m: Point) -> tuple[list[Wall], list[Block]]:
    """Return walls wall_1, wall_2, ... and convex blocks block_1, block_2, ..., whose union is the solid cells.

    Edges along the axes stay on the cells' borders; staircases become the straight lines that produce them. The solid
    area is cut where walls meet, then into convex pieces: axis-aligned rectangles up to 0.8 m thick are walls, all
    others blocks. The loss of a piece follows from the thickness of the wall that it is part of, in whole cells.

    Args:   solid: bool, shape (rows, cols), row 0 at the lowest y; no two cells touch only at a corner.
            low_m: lower left corner of cell (0, 0). cell_m: width and height of a cell, about equal.
    """
    return elements(outlines(solid), low_m, cell_m, _as_wall)


def elements(
    polygons: Iterable[shapely.Polygon],
    low_m: Point,
    cell_m: Point,
    as_wall: Callable[[str, Corners], Wall | None],
    kink: float = 0.0,
) -> tuple[list[Wall], list[Block]]:
    """Return walls wall_1, wall_2, ... and convex blocks block_1, block_2, ..., whose union is some polygons.

    Args: polygons: in cells.  as_wall: of a name and the corners of a piece [m]; None: it is a block.
          kink: corners this close to the line through their neighbours are removed after the cuts [cells].
    """
    edge_m = math.sqrt(cell_m[0] * cell_m[1])
    walls: list[Wall] = []
    blocks: list[Block] = []
    for polygon in polygons:
        parts = cut_at_inner_corners(polygon, MAX_WALL_THICKNESS_M / edge_m)
        straight = shapely.simplify(parts, kink) if kink else parts
        pieces = [piece for part in straight for piece in convex_pieces(part)]
        cells = np.maximum(piece_thickness(polygon, pieces, THICKEST_M / edge_m).round(), 1.0)
        for piece, thickness_m in zip(pieces, (cells * edge_m).round(6).tolist(), strict=True):
            corners = tuple((float(x), float(y)) for x, y in in_metres(low_m, cell_m, piece).tolist())
            thickness_m = None if math.isnan(thickness_m) else thickness_m  # it has no outer face
            wall = as_wall(f"wall_{len(walls) + 1}", corners)
            if wall and thickness_m in (None, wall.thickness_m):
                walls.append(wall)
            elif _is_sound(corners):
                blocks.append(Block(name=f"block_{len(blocks) + 1}", polygon=corners, thickness_m=thickness_m))
    return walls, blocks


def in_metres(low_m: Point, cell_m: Point, cells: np.ndarray) -> np.ndarray:
    """Convert points from cells to `map` [m], in whole micrometres to keep rounding errors out of the plan file."""
    points_m: np.ndarray = np.round(np.array(low_m) + cells * np.array(cell_m), 6)
    return points_m


def _is_sound(corners: Corners) -> bool:
    """Whether a piece is more than a sliver from rounding."""
    polygon = shapely.Polygon(corners)
    return bool(polygon.is_valid and polygon.area > MIN_PIECE_M2)


def _as_wall(name: str, corners: Corners) -> Wall | None:
    """Return a thin axis-aligned rectangle as a wall along its longer centre line; None if the polygon is not one."""
    (min_x, min_y), (max_x, max_y) = np.min(corners, axis=0).tolist(), np.max(corners, axis=0).tolist()
    width, depth = max_x - min_x, max_y - min_y
    thickness_m = round(min(width, depth), 6)
    upright = len(corners) == 4 and abs(shapely.Polygon(corners).area - width * depth) < 1e-9
    if not upright or not 0.0 < thickness_m <= MAX_WALL_THICKNESS_M:
        return None
    if width >= depth:
        y = round((min_y + max_y) / 2.0, 6)
        return Wall(name=name, start=(min_x, y), end=(max_x, y), thickness_m=thickness_m)
    x = round((min_x + max_x) / 2.0, 6)
    return Wall(name=name, start=(x, min_y), end=(x, max_y), thickness_m=thickness_m)
