"""A floor plan from an occupancy image as map_server reads it (yaml and pgm or png)."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from robotteamsim.errors import ScenarioError
from robotteamsim.map_import.cells import solid_cells
from robotteamsim.map_import.pieces import Piece, StraightPiece, in_metres, solid_pieces
from robotteamsim.scenario.base import MAX_NAME_CHARACTERS
from robotteamsim.scenario.floor_plan import Block, Bounds, FloorPlan, Wall
from robotteamsim.scenario.map_file import MapImage, read_map
from robotteamsim.scenario.plan_cache import cached_plan
from robotteamsim.scenario.problems import checked
from robotteamsim.wording import printable

CACHED_PIXELS = 200_000
"""Plans of larger images are kept in the cache."""


def import_map(map_yaml: str | os.PathLike[str]) -> FloorPlan:
    """Return the floor plan of a map_server image.

    `map_import.cells.solid_cells` decides which cells are solid, and `map_import.pieces.solid_pieces` converts them to
    walls and blocks. Plans of large images are taken from the cache, see `plan_cache`.

    Raises: ScenarioError: one line with file, key, value and what was expected.
    """
    path = Path(map_yaml)
    image = read_map(path)
    settings, pixels = image.settings, image.pixels
    cell_m = (settings.resolution, settings.resolution)
    low, high = in_metres(settings.origin[:2], cell_m, np.array([(0, 0), pixels.shape[1::-1]])).tolist()
    bounds = checked(Bounds, {"min": low, "max": high}, place=f"{path}: image: bounds.")
    if not (image.dark < settings.free_thresh).any():
        text = f"no cell of '{settings.image}' is free; is negate or free_thresh wrong?"
        raise ScenarioError(f"{path}: image: {text}")

    name = printable(path.stem)[:MAX_NAME_CHARACTERS]

    def plan() -> FloorPlan:
        return _plan(name, bounds, image)

    if pixels.shape[0] * pixels.shape[1] < CACHED_PIXELS:
        return plan()
    keys = f"{name} {settings.model_dump_json()} {pixels.shape}"
    return cached_plan((keys.encode(), pixels.tobytes()), plan)


def _plan(name: str, bounds: Bounds, image: MapImage) -> FloorPlan:
    settings = image.settings
    edge_m, thresholds = settings.resolution, (settings.occupied_thresh, settings.free_thresh)
    solid = solid_cells(image.dark, *thresholds, edge_m, closed=True)
    walls, blocks = walls_and_blocks(solid_pieces(solid, settings.origin[:2], (edge_m, edge_m)))
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
