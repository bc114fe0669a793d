"""What a team has found of a building, in the 3D scene: floor and walls over the true ones, wrong walls in red."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from robotteamsim import palette
from robotteamsim.nodes.scene.building import VOICE_LAYER
from robotteamsim.nodes.scene.shapes import Mesh, colour, drawn_below, faded, shaded
from robotteamsim.recording.topics.markers import Colour, Marker
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.plan import OccupancyGrid
from robotteamsim.view.found import FOUND_FREE, FOUND_WALL, WRONG_WALL, FoundLayers
from robotteamsim.view.scene import rectangles

FOUND, WRONG = colour(palette.FOUND), colour(palette.WRONGLY_FOUND)
FLOOR_Z_M, FLOOR_OPACITY = 0.01, 0.3
BEYOND_M = 0.02
"""Found walls cover the true ones by this [m]."""
MAX_CELLS = 80_000
"""A finer map is merged, because a marker is a list of points and not an image."""


class FoundPicture:
    """The maps of all robots as one: what one of them has found wrong counts, whatever others say."""

    def __init__(self, plan: FloorPlan, wall_height_m: float) -> None:
        self._layers, self._height_m = FoundLayers(plan, MAX_CELLS), wall_height_m + BEYOND_M

    def markers(self, maps: Mapping[int, OccupancyGrid]) -> Iterator[Marker]:
        """Yield the markers of the newest maps of robots, by their ids."""
        layers = [layer for grid in maps.values() if (layer := self._layers.layer(0.0, grid)) is not None]
        if not layers:
            return
        values, origin_m = np.maximum.reduce([one.values for one in layers]), layers[0].origin_m
        cell_m = layers[0].cell_m
        floor, walls = Mesh(), Mesh()
        for left, right, bottom, top in _placed(values == FOUND_FREE, origin_m, cell_m):
            corners = [(left, bottom, FLOOR_Z_M), (right, bottom, FLOOR_Z_M), (right, top, FLOOR_Z_M)]
            floor.quad([*corners, (left, top, FLOOR_Z_M)], [faded(FOUND, FLOOR_OPACITY)] * 4)
        for value, tint in ((FOUND_WALL, FOUND), (WRONG_WALL, WRONG)):
            for left, right, bottom, top in _placed(values == value, origin_m, cell_m):
                grown = left - BEYOND_M, right + BEYOND_M, bottom - BEYOND_M, top + BEYOND_M
                _box(walls, grown, self._height_m, tint)
        marker = floor.marker("found_floor", 0)
        marker.tint = faded(marker.tint, 0.99)  # rviz blends only what is not opaque
        yield drawn_below(marker, VOICE_LAYER)
        yield walls.marker("found_walls", 0)


def _placed(
    cells: np.ndarray, origin_m: tuple[float, float], cell_m: float
) -> Iterator[tuple[float, float, float, float]]:
    """Yield rectangles that cover cells: left, right, bottom, top [m]."""
    x0, y0 = origin_m
    for left, right, bottom, top in rectangles(cells):
        yield x0 + left * cell_m, x0 + right * cell_m, y0 + bottom * cell_m, y0 + top * cell_m


def _box(mesh: Mesh, sides: tuple[float, float, float, float], high_m: float, tint: Colour) -> None:
    """Add the top of a box, and its sides, which are darker below and away from the sun."""
    left, right, bottom, top = sides
    corners = [(left, bottom), (right, bottom), (right, top), (left, top)]
    mesh.quad([(x, y, high_m) for x, y in corners], [tint] * 4)
    for (x0, y0), (x1, y1), light in zip(corners, [*corners[1:], corners[0]], (0.6, 0.5, 0.75, 0.8), strict=True):
        high, low = shaded(tint, light), shaded(tint, 0.62 * light)
        mesh.quad([(x0, y0, 0.0), (x1, y1, 0.0), (x1, y1, high_m), (x0, y0, high_m)], [low, low, high, high])
