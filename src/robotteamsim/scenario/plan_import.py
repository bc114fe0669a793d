"""A floor plan from an occupancy image as map_server reads it (yaml and pgm or png)."""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import Literal

import cv2
import numpy as np
import shapely
from pydantic import ConfigDict, Field, ValidationError, model_validator

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.base import Model, PlanarPose, wrong
from robotteamsim.scenario.convex_pieces import convex_pieces
from robotteamsim.scenario.floor_plan import Block, Bounds, FloorPlan, Wall
from robotteamsim.scenario.inner_corners import cut_at_inner_corners
from robotteamsim.scenario.outlines import outlines
from robotteamsim.scenario.problems import problems
from robotteamsim.scenario.thickness import piece_thickness
from robotteamsim.scenario.yaml_text import is_file, read_mapping, shown

MAX_WALL_THICKNESS_M = 0.8
"""The loss table ends here: a thicker rectangle is a block."""

THICKEST_M = 1.0
"""What is thicker counts as this: the loss table knows no difference."""

MIN_PIECE_M2 = 1e-6
"""Smaller pieces are left out."""

WIDE_UNKNOWN_M = 1.0
"""An unknown region as wide as this both ways is taken for a void behind a wall, not for a wall."""

SPECK_CELLS = 3
"""Smaller groups of occupied cells are noise of the image."""

POCKET_M2 = 0.1
"""Smaller areas enclosed by solid cells are filled: nobody fits in."""


class MapFile(Model):
    """The yaml of a map_server image; keys that map_server does not know either are passed over."""

    model_config = ConfigDict(extra="ignore")

    image: str = Field(min_length=1, description="image file, relative to this file")
    resolution: float = Field(ge=0.001, le=10.0, description="edge of a pixel [m]")
    origin: PlanarPose = Field(description="[x, y, yaw] of the lower left pixel's corner; yaw must be 0")
    negate: Literal[0, 1, False, True] = Field(default=0, description="1: white is occupied")
    occupied_thresh: float = Field(default=0.65, gt=0.0, lt=1.0, description="darker than this share is occupied")
    free_thresh: float = Field(default=0.196, gt=0.0, lt=1.0, description="lighter than this share is free")
    mode: Literal["trinary", "scale"] = Field(default="trinary", description="both give the same plan")

    @model_validator(mode="after")
    def _check(self) -> MapFile:
        if self.origin[2] != 0.0:
            raise wrong("origin", f"yaw {self.origin[2]:g} is not 0; turn the image instead")
        if self.free_thresh >= self.occupied_thresh:
            raise wrong("free_thresh", f"{self.free_thresh:g} is not below occupied_thresh, {self.occupied_thresh:g}")
        return self


def import_map(map_yaml: str | os.PathLike[str]) -> FloorPlan:
    """Return the floor plan of a map_server image.

    - Occupied cells are solid; groups of fewer than three cells are dropped as noise, and
      enclosed pockets below 0.1 m^2 filled.
    - Unknown cells are solid where their region is narrower than 1 m; a wider one is a void behind a wall one cell
      thick wherever it meets free cells.
    - The image's outermost cells are solid, so that nobody leaves the map.
    Edges along the axes stay on the cells' borders; staircases become the straight lines that would be drawn so. The
    solid area is cut where walls meet, then into convex pieces: upright rectangles up to 0.8 m thick are walls, all
    others blocks. What a piece weighs is decided by the thickness of the wall that it is part of, in whole cells.

    Raises: ScenarioError: one line with file, key, value and what was wanted.
    """
    path = Path(map_yaml)
    settings = _read_settings(path)
    occupied, free = _read_cells(path, settings)
    bounds = _bounds(path, settings, *free.shape)
    solid = _solid_cells(occupied, free, settings.resolution)
    walls, blocks = solid_pieces(solid, settings.origin[:2], (settings.resolution, settings.resolution))
    return FloorPlan(name=path.stem, bounds=bounds, walls=tuple(walls), blocks=tuple(blocks))


def solid_pieces(
    solid: np.ndarray, low_m: tuple[float, float], cell_m: tuple[float, float]
) -> tuple[list[Wall], list[Block]]:
    """Return solid cells as walls and blocks, by the rules of `import_map`.

    Args:   solid: bool, shape (rows, cols), row 0 at the lowest y; no two cells touch by a corner alone.
            low_m: lower left corner of cell (0, 0). cell_m: width and height of a cell, about equal.
    """
    edge_m = math.sqrt(cell_m[0] * cell_m[1])
    walls: list[Wall] = []
    blocks: list[Block] = []
    for polygon in outlines(solid):
        parts = cut_at_inner_corners(polygon, MAX_WALL_THICKNESS_M / edge_m)
        pieces = [piece for part in parts for piece in convex_pieces(part)]
        cells = np.maximum(piece_thickness(polygon, pieces, THICKEST_M / edge_m).round(), 1.0)
        for piece, thickness_m in zip(pieces, (cells * edge_m).round(6).tolist(), strict=True):
            corners = [(float(x), float(y)) for x, y in _metres(low_m, cell_m, piece).tolist()]
            wall = _as_wall(f"wall_{len(walls) + 1}", corners)
            if wall and (math.isnan(thickness_m) or wall.thickness_m == thickness_m):
                walls.append(wall)
            elif _is_sound(corners):
                blocks.append(_as_block(f"block_{len(blocks) + 1}", corners, thickness_m))
    return walls, blocks


def read_image(path: Path) -> np.ndarray | None:
    """Return the pixels of an image; None: it cannot be read. OpenCV's own lines about that are kept from stderr."""
    level = cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    try:
        return cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    except cv2.error:  # a header that promises billions of pixels
        return None
    finally:
        cv2.utils.logging.setLogLevel(level)


def _read_settings(path: Path) -> MapFile:
    data = read_mapping(path, str(path), "the yaml of a map")
    try:
        return MapFile.model_validate(data)
    except ValidationError as error:
        raise ScenarioError(f"{path}: {problems(error, MapFile)[0]}") from None


def _metres(low_m: tuple[float, float], cell_m: tuple[float, float], cells: np.ndarray) -> np.ndarray:
    """Return places in cells as such in `map` [m], in whole micrometres: no digits from rounding in the plan file."""
    return np.round(np.array(low_m) + cells * np.array(cell_m), 6)


def _bounds(path: Path, settings: MapFile, rows: int, columns: int) -> Bounds:
    cell = (settings.resolution, settings.resolution)
    low, high = _metres(settings.origin[:2], cell, np.array([[0, 0], [columns, rows]])).tolist()
    try:
        return Bounds(min=tuple(low), max=tuple(high))
    except ValidationError as error:
        raise ScenarioError(f"{path}: image: bounds.{problems(error, Bounds)[0]}") from None


def _read_cells(path: Path, settings: MapFile) -> tuple[np.ndarray, np.ndarray]:
    """Return which cells are occupied and which are free; bool, shape (rows, cols), row 0 at the lowest y."""
    image_path = path.parent / settings.image
    if not is_file(image_path):
        raise ScenarioError(f"{path}: image: there is no file {shown(settings.image)}")
    image = read_image(image_path)
    if image is None or min(image.shape[:2]) < 3:
        raise ScenarioError(f"{path}: image: '{settings.image}' cannot be read as an image")
    if image.dtype not in (np.uint8, np.uint16):
        raise ScenarioError(f"{path}: image: '{settings.image}' has {image.dtype} pixels; wanted 8 or 16 bits")
    lightness = image.astype(np.float64) / (255.0 if image.dtype == np.uint8 else 65535.0)
    if lightness.ndim == 3:
        lightness = lightness[:, :, :3].mean(axis=2)
    occupancy = np.flipud(lightness if settings.negate else 1.0 - lightness)
    occupied, free = occupancy > settings.occupied_thresh, occupancy < settings.free_thresh
    if not free.any():
        raise ScenarioError(f"{path}: image: no cell of '{settings.image}' is free; is negate or free_thresh wrong?")
    return occupied, free


def _solid_cells(occupied: np.ndarray, free: np.ndarray, resolution_m: float) -> np.ndarray:
    """Return the cells that the plan makes solid, by the rules of `import_map`; no two touch by a corner alone."""
    unknown = ~(occupied | free)
    window = np.ones((max(1, round(WIDE_UNKNOWN_M / resolution_m)),) * 2, np.uint8)
    void = cv2.morphologyEx(unknown.astype(np.uint8), cv2.MORPH_OPEN, window).astype(bool)
    beside_free = cv2.dilate(free.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(bool)
    solid = occupied | (unknown & ~void) | (void & beside_free)
    solid[[0, -1]] = solid[:, [0, -1]] = True
    _, labels, statistics, _ = cv2.connectedComponentsWithStats(solid.astype(np.uint8), connectivity=8)
    solid &= statistics[labels, cv2.CC_STAT_AREA] >= SPECK_CELLS
    _, labels, statistics, _ = cv2.connectedComponentsWithStats((~solid).astype(np.uint8), connectivity=4)
    solid |= statistics[labels, cv2.CC_STAT_AREA] * resolution_m**2 < POCKET_M2
    return without_corner_contacts(solid)


def without_corner_contacts(solid: np.ndarray) -> np.ndarray:
    """Return the cells with one more wherever two touch by a corner alone: a wall drawn as such has no gaps."""
    solid = solid.copy()
    while True:
        a, b, c, d = solid[:-1, :-1], solid[:-1, 1:], solid[1:, :-1], solid[1:, 1:]
        rising, falling = ~a & b & c & ~d, a & ~b & ~c & d
        if not (rising.any() or falling.any()):
            return solid
        a |= rising
        b |= falling


def _is_sound(corners: list[tuple[float, float]]) -> bool:
    """Whether a piece is more than a sliver that rounding has left."""
    polygon = shapely.Polygon(corners)
    return bool(polygon.is_valid and polygon.area > MIN_PIECE_M2)


def _as_block(name: str, corners: list[tuple[float, float]], thickness_m: float) -> Block:
    return Block(name=name, polygon=tuple(corners), thickness_m=None if math.isnan(thickness_m) else thickness_m)


def _as_wall(name: str, corners: list[tuple[float, float]]) -> Wall | None:
    """Return an upright rectangle of wall thickness as a wall along its longer side; none: it is no such."""
    (min_x, min_y), (max_x, max_y) = np.min(corners, axis=0).tolist(), np.max(corners, axis=0).tolist()
    width, depth = max_x - min_x, max_y - min_y
    thickness = round(min(width, depth), 6)
    upright = len(corners) == 4 and abs(shapely.Polygon(corners).area - width * depth) < 1e-9
    if not upright or thickness > MAX_WALL_THICKNESS_M:
        return None
    if width >= depth:
        y = round((min_y + max_y) / 2.0, 6)
        start, end = (min_x, y), (max_x, y)
    else:
        x = round((min_x + max_x) / 2.0, 6)
        start, end = (x, min_y), (x, max_y)
    return Wall(name=name, start=start, end=end, thickness_m=thickness)
