"""Fire and smoke in the 3D scene."""

from collections.abc import Sequence

import numpy as np
from visualization_msgs.msg import Marker

from robotteamsim import palette
from robotteamsim.recording.hazard_messages import BURNING_VALUE, BURNT_OUT_VALUE
from robotteamsim.ros.scene.shapes import Colour, Mesh, Position, colour, faded, shaded

FLAME, CORE = colour(palette.FLAME), colour(palette.YELLOW)
CHAR, SMOKE = colour(palette.CHAR), colour(palette.SMOKE)
FLAME_M, CORE_M, CORE_SHARE = 1.4, 2.2, 0.5
"""Height of a flame and of its bright core, and width of the core; it shows above the smoke [m]."""
FLOOR_Z_M = 0.015
SMOKE_Z_M = 0.6
"""Height at which smoke is drawn, as a sheet above the robots, from which people and flames stand out [m]."""
DENSEST = 0.72
"""Opacity of smoke without any visibility."""
FAINTEST = 0.03
"""Thinner smoke is not drawn."""


def fire_markers(origin_m: tuple[float, float], resolution_m: float, cells: np.ndarray) -> list[Marker]:
    """Return flames where it burns, and burnt ground. Args: cells: of /fire/grid, shape (rows, cols)."""
    flames, ground = Mesh(), Mesh()
    for row, column in np.argwhere(cells == BURNT_OUT_VALUE).tolist():
        ground.quad(_square(origin_m, resolution_m, row, column, FLOOR_Z_M), [CHAR] * 4)
    for row, column in np.argwhere(cells == BURNING_VALUE).tolist():
        square = _square(origin_m, resolution_m, row, column, FLOOR_Z_M)
        ground.quad(square, [shaded(FLAME, 0.7)] * 4)
        x, y = origin_m[0] + (column + 0.5) * resolution_m, origin_m[1] + (row + 0.5) * resolution_m
        # Neighbouring flames differ in height, by a pattern without chance.
        share = 0.7 + 0.1 * ((3 * row + 5 * column) % 7)
        inner = [(x + CORE_SHARE * (px - x), y + CORE_SHARE * (py - y), z) for px, py, z in square]
        _cone(flames, square, (x, y, FLAME_M * share), FLAME, FLAME)
        _cone(flames, inner, (x, y, CORE_M * share), FLAME, CORE)
    named = (("burnt ground", ground), ("flames", flames))
    return [mesh.marker(name, 0) for name, mesh in named if len(mesh)]


def smoke_markers(origin_m: tuple[float, float], resolution_m: float, cells: np.ndarray) -> list[Marker]:
    """Return the smoke as a sheet, more opaque where one sees less far. Args: cells: of /smoke/grid."""
    opacity = DENSEST * np.clip(cells, 0, 100) / 100.0
    # The opacity of a corner is the mean of the cells around it.
    padded = np.pad(opacity, 1, mode="edge")
    corners = (padded[:-1, :-1] + padded[1:, :-1] + padded[:-1, 1:] + padded[1:, 1:]) / 4.0
    mesh = Mesh()
    for row, column in np.argwhere(opacity > FAINTEST).tolist():
        tints = [
            faded(SMOKE, float(corners[i, j]))
            for i, j in ((row, column), (row, column + 1), (row + 1, column + 1), (row + 1, column))
        ]
        mesh.quad(_square(origin_m, resolution_m, row, column, SMOKE_Z_M), tints)
    if not len(mesh):
        return []
    marker = mesh.marker("smoke", 0)
    marker.color.a = DENSEST  # rviz blends only what is not opaque
    return [marker]


def _cone(mesh: Mesh, base: Sequence[Position], tip: Position, low: Colour, high: Colour) -> None:
    for a, b in zip(base, (*base[1:], base[0]), strict=True):
        mesh.triangle((a, b, tip), [low, low, high])


def _square(
    origin_m: tuple[float, float], resolution_m: float, row: int, column: int, z_m: float
) -> Sequence[tuple[float, float, float]]:
    x, y = origin_m[0] + column * resolution_m, origin_m[1] + row * resolution_m
    return [
        (x, y, z_m),
        (x + resolution_m, y, z_m),
        (x + resolution_m, y + resolution_m, z_m),
        (x, y + resolution_m, z_m),
    ]
