"""Lifts of Open-RMF's buildings: their shafts on each level, and the passages that they are."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import shapely

from robotteamsim.errors import ScenarioError
from robotteamsim.formats.open_rmf_file import (
    SHAFT_M,
    SHORTEST_M,
    WALL_HEIGHT_M,
    WALL_M,
    Building,
    Lift,
    LiftDoor,
    Places,
    rounded,
)
from robotteamsim.formats.side_by_side import LIFT, DrawnPassage
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.floor_plan import Block
from robotteamsim.scenario.problems import checked
from robotteamsim.wording import counted


@dataclass(frozen=True)
class Shaft:
    """The shaft of a lift in the map.

    turn, half: direction of its first side, and half its sides, x + i y [m].
    openings:   of its doors at a level, from the middle of the cabin; none if it does not stop there.
    goes_down:  whether it goes through the floor of that level.
    """

    key: str
    name: str
    center: complex
    turn: complex
    half: complex
    openings: tuple[LiftDoor, ...]
    goes_down: bool

    @property
    def corners(self) -> list[complex]:
        """Its corners, counter-clockwise [m]."""
        x, y = self.half.real, self.half.imag
        return [self.center + self.turn * complex(*corner) for corner in ((x, y), (-x, y), (-x, -y), (x, -y))]

    def block(self) -> dict[str, Any]:
        """Return it as a block."""
        return {"name": f"lift {self.name}", "polygon": list(map(rounded, self.corners))}

    def walls(self) -> Iterator[dict[str, Any]]:
        """Yield its walls, around the cabin, with gaps for the doors of the side that each is nearest to."""
        gaps: dict[int, list[tuple[float, float]]] = {side: [] for side in range(4)}
        for door in self.openings:
            side = 0 if abs(door.y) / self.half.imag >= abs(door.x) / self.half.real else 1
            along, is_far = (door.x, door.y < 0.0) if side == 0 else (door.y, door.x < 0.0)
            gaps[side + 2 * is_far].append((along - 0.5 * door.width, along + 0.5 * door.width))
        for side, taken in gaps.items():
            half_m = self.half.real if side % 2 == 0 else self.half.imag
            for number, (first, last) in enumerate(remaining(half_m, taken), 1):
                ends = (self._on_side(side, at) for at in (first, last))
                keys = dict(zip(("from", "to"), map(rounded, ends), strict=True))
                size = {"thickness_m": WALL_M, "height_m": WALL_HEIGHT_M}
                yield {"name": f"lift {self.name} wall_{side + 1}_{number}", **keys, **size}

    def _on_side(self, side: int, along_m: float) -> complex:
        x, y = self.half.real, self.half.imag
        place = (complex(along_m, y), complex(x, along_m), complex(along_m, -y), complex(-x, along_m))[side]
        return self.center + self.turn * place


def remaining(half_m: float, gaps: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return what gaps leave of a side from -half_m to half_m."""
    side = shapely.LineString([(-half_m, 0.0), (half_m, 0.0)])
    cut = shapely.difference(side, shapely.union_all([shapely.box(low, -1.0, high, 1.0) for low, high in gaps]))
    parts = [part for part in shapely.get_parts(cut) if part.length > SHORTEST_M]
    return [(part.bounds[0], part.bounds[2]) for part in parts]


def shafts_at(path: Path, building: Building, level: str, places: Places) -> Iterator[Shaft]:
    """Yield the shafts of lifts at a level, from the lowest to the highest that they serve. Raises: ScenarioError."""
    for name, lift in building.lifts.items():
        key = f"{path}: lifts.{name}"
        _check(key, lift, building)
        served = [one for one, doors in lift.level_doors.items() if doors and one in building.levels]
        served_m = [building.levels[one].elevation for one in served]
        elevation_m = building.levels[level].elevation
        if not served_m or not min(served_m) <= elevation_m <= max(served_m):
            continue
        center = places.of(lift.reference_floor_name or places.reference).of(lift.x, lift.y)
        half = complex(0.5 * lift.width + SHAFT_M, 0.5 * lift.depth + SHAFT_M)
        openings = tuple(lift.doors[door] for door in lift.level_doors.get(level, ()) if door in lift.doors)
        shaft = Shaft(key, name, center, cmath.exp(1j * lift.yaw), half, openings, elevation_m > min(served_m))
        checked(Block, shaft.block(), place=f"{shaft.key}: ")
        yield shaft


def _check(key: str, lift: Lift, building: Building) -> None:
    """Raise ScenarioError if a number of a lift is impossible, or its reference floor is unknown."""
    sizes = {"width": lift.width, "depth": lift.depth}
    sizes |= {f"doors.{name}.width": door.width for name, door in lift.doors.items()}
    places = {"x": lift.x, "y": lift.y, "yaw": lift.yaw}
    places |= {f"doors.{name}.{axis}": getattr(door, axis) for name, door in lift.doors.items() for axis in "xy"}
    for name, value in (sizes | places).items():
        if not math.isfinite(value) or (name in sizes and value <= 0.0):
            expected = "a number above 0" if name in sizes else "a finite number"
            raise ScenarioError(f"{key}.{name}: {value:g}; expected {expected}")
    if (floor := lift.reference_floor_name) and floor not in building.levels:
        known = f"expected one of {', '.join(building.levels)}"
        raise ScenarioError(f"{key}.reference_floor_name: there is no level '{floor}'; {known}")


def lifts_of(path: Path, building: Building, places: Places) -> Iterator[DrawnPassage]:
    """Yield the lifts, each with a stop in the middle of its cabin at each level at which it has doors."""
    found: dict[str, dict[str, Point]] = {}
    for level in building.levels:
        for shaft in shafts_at(path, building, level, places):
            if shaft.openings:
                found.setdefault(shaft.name, {})[level] = rounded(shaft.center)
    for name, stops in found.items():
        yield DrawnPassage({"name": name, **LIFT}, stops)


def lift_notes(building: Building, drawn: Sequence[str]) -> Iterator[str]:
    """Yield where lifts cannot stop, and which join no levels. Args: drawn: names of the levels that are imported."""
    for name, lift in building.lifts.items():
        stops = 0
        for level, doors in lift.level_doors.items():
            known = [door for door in doors if door in lift.doors]
            stops += bool(known) and level in drawn
            if doors and level not in drawn:
                why = "it has no walls" if level in building.levels else "there is no such level"
                yield f"lift {name}: no stop at {level}: {why}"
            elif doors and not known:
                yield f"lift {name}: no stop at {level}: the lift has no door '{doors[0]}'"
        if stops < 2:
            yield f"lift {name}: joins no levels: it has {counted(stops, 'stop')}"
