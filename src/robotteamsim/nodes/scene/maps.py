"""Maps in the 3D scene: voice, fire and smoke as coloured layers over the floor."""

import math
from collections.abc import Sequence

import numpy as np
from scipy import ndimage

from robotteamsim import palette
from robotteamsim.nodes.scene.building import SMOKE_LAYER, VOICE_LAYER, VOICE_Z_M
from robotteamsim.nodes.scene.shapes import Mesh, colour, drawn_below, faded
from robotteamsim.propagation import FieldMap
from robotteamsim.recording.topics.markers import Colour, Marker
from robotteamsim.recording.topics.world import BURNING_VALUE, BURNT_OUT_VALUE
from robotteamsim.scenario.plan import Grid, OccupancyGrid

FINEST_CELL_M, LOUDEST_DB = 0.01, 300.0
MAX_CELLS = 12_000
"""Largest number of cells; a finer map is thinned, because a marker is a list of points and not an image."""
Scale = Sequence[tuple[float, Colour]]
"""Ascending values and their colours."""

VOICE: Scale = [
    (level_db, colour(code, opacity))
    for (level_db, code), opacity in zip(palette.VOICE, (0.40, 0.50, 0.60, 0.68, 0.75), strict=True)
]
FADE_DB = 8.0
"""The voice layer fades out over this range above the noise, so that its edge does not show the cells."""
PILLAR_M = 1.5
"""Smaller silent holes are filled: pillars would tear the layer."""
FIRE: Scale = [
    (0.0, colour(palette.CHAR, 0.0)),
    (BURNT_OUT_VALUE, colour(palette.CHAR, 0.9)),
    (BURNING_VALUE, colour(palette.FLAME, 0.95)),
]
SMOKE: Scale = [(0.0, colour(palette.SMOKE, 0.0)), (100.0, colour(palette.SMOKE, 0.72))]
SMOKE_Z_M, FIRE_Z_M = 0.6, 0.65
"""Smoke is a sheet above the robots, from which people stand out; it does not hide fire [m]."""


def voice_markers(voice: FieldMap) -> list[Marker]:
    """Return a voice map; nothing without voices. Raises: ValueError: too fine, or impossible levels."""
    levels_db = voice.values
    if not (voice.resolution_m >= FINEST_CELL_M and ((levels_db >= 0.0) & (levels_db <= LOUDEST_DB)).all()):
        raise ValueError(f"expected cells of at least {FINEST_CELL_M:g} m and levels of 0 to {LOUDEST_DB:g} dB")
    if min(levels_db.shape) < 2 or not (levels_db > 0.0).any():
        return []
    closed_db = ndimage.grey_closing(levels_db, size=math.ceil(PILLAR_M / voice.resolution_m))
    levels_db = np.where(levels_db > 0.0, levels_db, closed_db)
    faintest_db = levels_db[levels_db > 0.0].min()
    x_m, y_m = _centers_m(voice, levels_db)
    fade = np.clip((levels_db - faintest_db) / FADE_DB, 0.0, 1.0)
    return [drawn_below(_layer("voice", x_m, y_m, levels_db, VOICE, VOICE_Z_M, fade), VOICE_LAYER)]


def fire_markers(grid: OccupancyGrid) -> list[Marker]:
    """Return the cells that burn or have burnt."""
    return _grid_markers("fire", grid, FIRE, FIRE_Z_M)


def smoke_markers(grid: OccupancyGrid) -> list[Marker]:
    """Return smoke, more opaque where one sees less far."""
    return [drawn_below(item, SMOKE_LAYER) for item in _grid_markers("smoke", grid, SMOKE, SMOKE_Z_M)]


def _grid_markers(name: str, grid: OccupancyGrid, scale: Scale, z_m: float) -> list[Marker]:
    if not (grid.cells > 0).any():
        return []
    return [_layer(name, *_centers_m(grid, grid.cells), grid.cells, scale, z_m)]


def _centers_m(grid: Grid, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the x of the centres of columns, and the y of those of rows [m]."""
    (x0, y0), (rows, columns) = grid.origin_m, values.shape
    return x0 + (np.arange(columns) + 0.5) * grid.resolution_m, y0 + (np.arange(rows) + 0.5) * grid.resolution_m


def _layer(
    name: str,
    x_m: np.ndarray,
    y_m: np.ndarray,
    values: np.ndarray,
    scale: Scale,
    z_m: float,
    fade: np.ndarray | float = 1.0,
) -> Marker:
    """Return quadrilaterals between the centres of neighbouring cells, so that colours blend. Zeros are transparent."""
    limits, colours = zip(*scale, strict=True)
    tints = np.stack([np.interp(values, limits, part) for part in zip(*colours, strict=True)], axis=-1)
    tints[..., 3] *= fade
    every = slice(None, None, math.ceil(math.sqrt(values.size / MAX_CELLS)))
    shown, xs, ys = values[every, every] > 0.0, x_m[every].tolist(), y_m[every].tolist()
    tint: list[list[Colour]] = tints[every, every].tolist()
    mesh = Mesh()
    for i, j in np.argwhere(shown[:-1, :-1] | shown[:-1, 1:] | shown[1:, :-1] | shown[1:, 1:]).tolist():
        around = ((i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j))
        mesh.quad([(xs[column], ys[row], z_m) for row, column in around], [tint[row][column] for row, column in around])
    result = mesh.marker(name, 0)
    result.tint = faded(result.tint, 0.99)  # rviz blends only what is not opaque
    return result
