"""A floor plan from an occupancy image as map_server reads it (yaml and pgm or png)."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import ConfigDict, Field, model_validator

from robotteamsim.errors import ScenarioError
from robotteamsim.map_import.cells import darkness, read_image, solid_cells
from robotteamsim.map_import.pieces import Piece, StraightPiece, in_metres, solid_pieces
from robotteamsim.scenario.base import MAX_NAME_CHARACTERS, Model, PlanarPose, wrong
from robotteamsim.scenario.floor_plan import Block, Bounds, FloorPlan, Wall
from robotteamsim.scenario.problems import checked
from robotteamsim.scenario.yaml_text import is_file, read_mapping, shown
from robotteamsim.wording import printable


class MapFile(Model):
    """The yaml of a map_server image; unknown keys are ignored, as by map_server."""

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

    `map_import.cells.solid_cells` decides which cells are solid, and `map_import.pieces.solid_pieces` converts them to
    walls and blocks.

    Raises: ScenarioError: one line with file, key, value and what was expected.
    """
    path = Path(map_yaml)
    settings = checked(MapFile, read_mapping(path, str(path), "the yaml of a map"), place=f"{path}: ")
    occupied, free = _read_cells(path, settings)
    cell_m = (settings.resolution, settings.resolution)
    low, high = in_metres(settings.origin[:2], cell_m, np.array([(0, 0), free.shape[::-1]])).tolist()
    bounds = checked(Bounds, {"min": low, "max": high}, place=f"{path}: image: bounds.")
    solid = solid_cells(occupied, free, settings.resolution)
    walls, blocks = walls_and_blocks(solid_pieces(solid, settings.origin[:2], cell_m))
    name = printable(path.stem)[:MAX_NAME_CHARACTERS]
    return FloorPlan(name=name, bounds=bounds, walls=tuple(walls), blocks=tuple(blocks))


def walls_and_blocks(pieces: Iterable[Piece]) -> tuple[list[Wall], list[Block]]:
    """Return pieces of an image as elements of a plan, named wall_1, wall_2, ... and block_1, block_2, ..."""
    walls: list[Wall] = []
    blocks: list[Block] = []
    for piece in pieces:
        if isinstance(piece, StraightPiece):
            name = f"wall_{len(walls) + 1}"
            walls.append(Wall(name=name, start=piece.start, end=piece.end, thickness_m=piece.thickness_m))
        else:
            name = f"block_{len(blocks) + 1}"
            blocks.append(Block(name=name, polygon=piece.corners, thickness_m=piece.thickness_m))
    return walls, blocks


def _read_cells(path: Path, settings: MapFile) -> tuple[np.ndarray, np.ndarray]:
    """Return which cells are occupied and which are free; bool, shape (rows, cols), row 0 at the lowest y."""
    image_path = path.parent / settings.image
    if not is_file(image_path):
        raise ScenarioError(f"{path}: image: there is no file {shown(settings.image)}")
    try:
        image = read_image(image_path)
    except ValueError as error:
        raise ScenarioError(f"{path}: image: '{settings.image}' has {error}") from None
    if image is None or min(image.shape[:2]) < 3:
        raise ScenarioError(f"{path}: image: '{settings.image}' cannot be read as an image")
    if image.dtype not in (np.uint8, np.uint16):
        raise ScenarioError(f"{path}: image: '{settings.image}' has {image.dtype} pixels; expected 8 or 16 bits")
    dark = darkness(image, negate=bool(settings.negate))
    occupied, free = dark > settings.occupied_thresh, dark < settings.free_thresh
    if not free.any():
        raise ScenarioError(f"{path}: image: no cell of '{settings.image}' is free; is negate or free_thresh wrong?")
    return occupied, free
