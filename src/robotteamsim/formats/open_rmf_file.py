"""What a `building.yaml` of Open-RMF contains, and where its levels lie, as rmf_building_map_tools 1.13.0 has it."""

from __future__ import annotations

import cmath
import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import msgspec
import numpy as np

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.problems import suggestion
from robotteamsim.scenario.yaml_text import read_mapping

WALL_M, WALL_HEIGHT_M, LONGER_M = 0.1, 2.5, 0.05
"""Thickness and height of walls, and by how much they are longer at each end, so that corners close."""
LEAF_M, LEAF_HEIGHT_M = 0.03, 2.2
SHAFT_M = 0.05
"""By how much the shaft of a lift is wider than its cabin, on each side."""
SHORTEST_M = 1e-6
_MOST_PIXELS, _MOST_FIDUCIALS = 1e9, 1000

_Part = TypeVar("_Part")

Parameters = dict[str, tuple[int, Any]]
"""[code, value] by name; code: 1 string, 2 integer, 3 real, 4 boolean."""


class Floor(msgspec.Struct):
    """A floor, or a hole in all floors of its level."""

    vertices: list[int]


class Level(msgspec.Struct):
    """A level, in pixels or metres.

    vertices:                   [x, y, z, name, parameters].
    walls, doors, measurements: two vertices, parameters.
    fiducials:                  x, y, name.
    """

    vertices: list[list[Any]]
    elevation: float = 0.0
    walls: list[tuple[int, int, Parameters]] = []
    doors: list[tuple[int, int, Parameters]] = []
    measurements: list[tuple[int, int, Parameters]] = []
    fiducials: list[tuple[float, float, str | int]] = []
    floors: list[Floor] = []
    holes: list[Floor] = []


class LiftDoor(msgspec.Struct):
    """A door of a lift. x, y: from the middle of the cabin [m].  width: [m]."""

    x: float
    y: float
    width: float


class Lift(msgspec.Struct):
    """A lift.

    x, y:         its middle in the drawing of the reference floor.
    yaw:          of its width, in the map [rad].
    width, depth: of the cabin [m].
    level_doors:  names of doors by level.
    """

    x: float
    y: float
    yaw: float
    width: float
    depth: float
    reference_floor_name: str = ""
    level_doors: dict[str, list[str]] = {}
    doors: dict[str, LiftDoor] = {}


class Building(msgspec.Struct):
    """What is read of a file."""

    levels: dict[str, Level]
    name: str = ""
    building_name: str = ""
    coordinate_system: str = "reference_image"
    reference_level_name: str = ""
    lifts: dict[str, Lift] = {}


def read_building(path: Path) -> Building:
    """Return the contents of a file. Raises: ScenarioError: one line with the level or lift that is wrong."""
    data = read_mapping(path, str(path), "a building of Open-RMF")
    for key, kind in (("levels", Level), ("lifts", Lift)):  # first, for msgspec does not name the keys of mappings
        parts = data.get(key)
        for name, part in parts.items() if isinstance(parts, dict) else ():
            _converted(f"{path}: {key}.{name}", part, kind)
    building = _converted(str(path), data, Building)
    for name, level in building.levels.items():
        if not math.isfinite(level.elevation):
            raise ScenarioError(f"{path}: levels.{name}.elevation: {level.elevation:g}; expected a finite number")
    return building


def _converted(place: str, data: Any, kind: type[_Part]) -> _Part:
    try:
        return msgspec.convert(data, kind)
    except msgspec.ValidationError as error:
        raise ScenarioError(f"{place}: {error}") from None


@dataclass(frozen=True)
class Place:
    """How a level lies in the map: z becomes factor z + shift; x + i y in its drawing, y upwards."""

    factor: complex
    shift: complex
    y_sign: float

    def of(self, x: float, y: float) -> complex:
        """Return a point of the drawing in the map [m]."""
        return self.factor * complex(x, self.y_sign * y) + self.shift


class Places:
    """How the levels of a building lie in the map."""

    def __init__(self, path: Path, building: Building) -> None:
        """Place none yet. Raises: ScenarioError: no levels, no walls, or another coordinate system."""
        if not building.levels:
            raise ScenarioError(f"{path}: levels: none")
        if not any(level.walls for level in building.levels.values()):  # such as a map of lanes
            raise ScenarioError(f"{path}: has no walls, so there is no building to import")
        if building.coordinate_system not in ("reference_image", "cartesian_meters"):
            text = f"coordinate_system: '{building.coordinate_system}'; expected reference_image or cartesian_meters"
            raise ScenarioError(f"{path}: {text}")
        self._path, self._building = path, building
        self.reference = building.reference_level_name or next(iter(building.levels))
        self.notes: list[str] = []
        """What is doubtful about the levels that were placed."""

    def to_import(self) -> list[str]:
        """Return the levels that have walls, the reference level first, then from the lowest up."""
        levels = self._building.levels
        names = [name for name in levels if levels[name].walls]
        names.sort(key=lambda name: (name != self.reference, levels[name].elevation))
        self.notes += [f"level {name}: has no walls" for name in levels if name not in names]
        return names

    def level(self, name: str) -> Level:
        """Return a level. Raises: ScenarioError: there is none of this name."""
        levels = self._building.levels
        if name not in levels:
            known = f"expected one of {', '.join(levels)}{suggestion(name, list(levels))}"
            raise ScenarioError(f"{self._path}: there is no level '{name}'; {known}")
        return levels[name]

    def of(self, name: str) -> Place:
        """Return the place of a level. Raises: ScenarioError: there is none, or its scale is unknown."""
        for known in (self.reference, name):
            self.level(known)
        if self._building.coordinate_system == "cartesian_meters":
            return Place(1.0 + 0.0j, 0.0j, 1.0)
        if name == self.reference:
            return Place(complex(self._scale_m(name)), 0.0j, -1.0)
        drawn, expected = (self._fiducials(one) for one in (name, self.reference))
        if shared := sorted(drawn.keys() & expected.keys(), key=str):
            factor, shift = _alignment([drawn[key] for key in shared], [expected[key] for key in shared])
            if factor:
                scale_m = self._scale_m(self.reference)
                return Place(scale_m * factor, scale_m * shift, -1.0)
        self.notes.append(
            f"level {name} shares fewer than two fiducials with {self.reference}: it lies by its own measurements, "
            "where Open-RMF takes a pixel as a metre"
        )
        return Place(complex(self._scale_m(name)), 0.0j, -1.0)

    def _scale_m(self, name: str) -> float:
        """Return the metres per pixel of a level by its measurements. Raises: ScenarioError: it has none."""
        level, ratios = self.level(name), []
        for index, (start, end, parameters) in enumerate(level.measurements):
            key = f"{self._path}: levels.{name}.measurements.{index}"
            edge = Edge(key, complex(*vertex_of(key, level, start)), complex(*vertex_of(key, level, end)), parameters)
            distance_m, pixels = number(edge, "distance"), abs(edge.end - edge.start)
            if not (distance_m > 0.0 and pixels > 0.0):
                raise ScenarioError(f"{key}: {distance_m:g} m for {pixels:g} pixels; expected more than 0")
            ratios.append(distance_m / pixels)
        if not ratios:
            raise ScenarioError(f"{self._path}: levels.{name}: has no measurement, so its scale is unknown")
        return float(np.mean(ratios))

    def _fiducials(self, name: str) -> dict[str | int, complex]:
        """Return the fiducials of a level by name, in pixels with y upwards. Raises: ScenarioError: one far away."""
        if (count := len(self.level(name).fiducials)) > _MOST_FIDUCIALS:
            text = f"{count} entries; expected at most {_MOST_FIDUCIALS}"
            raise ScenarioError(f"{self._path}: levels.{name}.fiducials: {text}")
        for x, y, fiducial in self.level(name).fiducials:
            if not (abs(x) <= _MOST_PIXELS and abs(y) <= _MOST_PIXELS):
                raise ScenarioError(
                    f"{self._path}: levels.{name}.fiducials: '{fiducial}' is at [{x:g}, {y:g}]; expected pixels"
                )
        return {fiducial: complex(x, -y) for x, y, fiducial in self.level(name).fiducials}


def _alignment(here: Sequence[complex], there: Sequence[complex]) -> tuple[complex, complex]:
    """Return factor and shift from the fiducials of a level to those of the reference level, over all pairs.

    A factor of 0: no two of them are apart.
    """
    turns, ratios = [], []
    for (a, b), (c, d) in zip(itertools.combinations(here, 2), itertools.combinations(there, 2), strict=True):
        if a != b and c != d:
            turns.append(cmath.exp(1j * (cmath.phase(d - c) - cmath.phase(b - a))))
            ratios.append(abs(d - c) / abs(b - a))
    if not ratios:
        return 0.0j, 0.0j
    factor = complex(np.mean(ratios)) * cmath.exp(1j * cmath.phase(sum(turns)))
    return factor, complex(np.mean(np.array(there) - factor * np.array(here)))


def vertex_of(key: str, level: Level, index: int) -> tuple[float, float]:
    """Return x and y of a vertex in the drawing. Raises: ScenarioError: there is none, or it has no place."""
    if not 0 <= index < len(level.vertices):
        raise ScenarioError(f"{key}: vertex {index}; expected 0 to {len(level.vertices) - 1}")
    vertex = level.vertices[index][:2]
    if len(vertex) < 2 or not all(map(_is_number, vertex)):
        raise ScenarioError(f"{key}: vertex {index} is at {vertex!s:.60}; expected two numbers")
    return float(vertex[0]), float(vertex[1])


def number(edge: Edge, name: str, default: float | None = None) -> float:
    """Return a parameter. Raises: ScenarioError: it is missing, or no number."""
    _, value = edge.parameters.get(name, (3, default))
    if not _is_number(value):
        raise ScenarioError(f"{edge.key}.{name}: {'missing' if value is None else value!s:.60}; expected a number")
    return float(value)


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


class Edge(NamedTuple):
    """A wall or a door in the map, with the key of its parameters in the file."""

    key: str
    start: complex
    end: complex
    parameters: Parameters


def rounded(z: complex) -> Point:
    """Return a point of the map as it is in a plan [m]."""
    return round(z.real, 6), round(z.imag, 6)
