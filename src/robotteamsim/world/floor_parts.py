"""The separate parts of a plan's floor: rooms without a door, and enclosed areas."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from robotteamsim import _core
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.building import building_of
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.plan import FREE, Grid

CELL_M = 0.1

MOST_CELLS = 25_000_000
"""Larger plans are not divided into parts: 500 m x 500 m."""

LEAST_M2 = 1.0
"""Smaller parts are not reported."""

_MOST_PARTS = 1000
_NEAR_M = 1.0
"""How far from a start the floor may begin, if the start itself is too close to a wall."""


class FloorPart(NamedTuple):
    """A part of the floor that no door connects with the others. place: somewhere in its middle [m, map]."""

    area_m2: float
    place: Point


def part_text(part: FloorPart) -> str:
    """Return area and place of a part for a message."""
    return f"{part.area_m2:.1f} m2 around [{part.place[0]:g}, {part.place[1]:g}]"


def floor_parts(plan: FloorPlan, radius_m: float) -> tuple[FloorPart, ...]:
    """Return the parts of the floor between which a disc cannot move, even through open doors, the largest first.

    Parts below LEAST_M2 are omitted. A plan of more than MOST_CELLS cells is not examined: it has no parts.

    Args: radius_m: of the disc; areas are those that its centre can be in.
    """
    grid = _grid(plan, radius_m)
    return () if grid is None else tuple(part for part, _ in _parts(grid))


def parts_without(plan: FloorPlan, radius_m: float, starts: Sequence[Point]) -> tuple[FloorPart, ...]:
    """Return the parts of the floor that a disc cannot reach from any of some starts [m, map]; see `floor_parts`."""
    grid = _grid(plan, radius_m)
    if grid is None:
        return ()
    places = [place for start in starts if (place := grid.core.nearest_free(start, _NEAR_M)) is not None]
    return tuple(part for part, inside in _parts(grid) if not any(inside[grid.cell_at(*place)] for place in places))


@dataclass(frozen=True, slots=True, eq=False)
class _DiscGrid(Grid):
    """Where a disc has room. core: the same for the C++ library."""

    core: _core.plan.PlanningGrid


def _grid(plan: FloorPlan, radius_m: float) -> _DiscGrid | None:
    """Return where a disc has room if all doors are open; None if the plan is too large."""
    (x0, y0), (x1, y1) = plan.bounds.min, plan.bounds.max
    if (x1 - x0) * (y1 - y0) / CELL_M**2 > MOST_CELLS:
        return None
    floor = building_of(plan).grid_without_doors(CELL_M)
    core = _core.plan.PlanningGrid(floor.cells != FREE, floor.origin_m, CELL_M, radius_m)
    return _DiscGrid(floor.origin_m, CELL_M, core)


def _parts(grid: _DiscGrid) -> list[tuple[FloorPart, np.ndarray]]:
    """Return each part with its cells, bool, the largest first."""
    left = ~grid.core.blocked().astype(bool)
    found: list[tuple[FloorPart, np.ndarray]] = []
    for _ in range(_MOST_PARTS):
        if not left.any():
            break
        first = np.unravel_index(int(np.argmax(left)), left.shape)
        inside = np.isfinite(grid.core.distance_map(_centre(grid, *first))) & left
        inside[first] = True
        left &= ~inside
        area_m2 = float(np.count_nonzero(inside)) * CELL_M**2
        if area_m2 >= LEAST_M2:
            found.append((FloorPart(area_m2, _middle(grid, inside)), inside))
    return sorted(found, key=lambda part: -part[0].area_m2)


def _middle(grid: _DiscGrid, inside: np.ndarray) -> Point:
    """Return the centre of the cell of a part that is nearest to the middle of all its cells."""
    cells = np.argwhere(inside)
    nearest = int(np.argmin(((cells - cells.mean(axis=0)) ** 2).sum(axis=1)))
    return _centre(grid, *cells[nearest])


def _centre(grid: _DiscGrid, row: np.integer, column: np.integer) -> Point:
    (x, y), cell_m = grid.origin_m, grid.resolution_m
    return round(x + cell_m * (int(column) + 0.5), 3), round(y + cell_m * (int(row) + 0.5), 3)
