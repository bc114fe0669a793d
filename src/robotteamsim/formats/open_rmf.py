"""Imports levels of Open-RMF's buildings (`building.yaml`), as rmf_building_map_tools 1.13.0 reads them."""

from __future__ import annotations

import cmath
import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import msgspec
import numpy as np

from robotteamsim.errors import ScenarioError
from robotteamsim.formats.drawings import drawn
from robotteamsim.formats.importer import Imported, Importer
from robotteamsim.formats.options import Options
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.floor_plan import Block, Bounds, FloorPlan
from robotteamsim.scenario.map_image import DrawingRules
from robotteamsim.scenario.materials import Layer, Material
from robotteamsim.scenario.problems import checked, suggestion
from robotteamsim.scenario.yaml_text import read_mapping
from robotteamsim.wording import counted

WALL_M, WALL_HEIGHT_M, LONGER_M = 0.1, 2.5, 0.05
"""Thickness and height of walls, and by how much they are longer at each end, so that corners close."""
LEAF_M, LEAF_HEIGHT_M = 0.03, 2.2
SHAFT_M = 0.05
"""By how much the shaft of a lift is wider than its cabin, on each side."""
_GLASS = Material(name="glass", layers=(Layer(of="glass", thickness_m=0.006),))
_MARGIN_M = 0.5
_ANY_M = 0.0, math.inf
_MOST_M = 1e5

Parameters = dict[str, tuple[int, Any]]
"""[code, value] by name; code: 1 string, 2 integer, 3 real, 4 boolean."""


class _Floor(msgspec.Struct):
    vertices: list[int]
    holes: list[Any] = []


class _Level(msgspec.Struct):
    """vertices: [x, y, z, name, parameters]. walls, doors, measurements: two vertices, parameters."""

    vertices: list[list[Any]]
    elevation: float = 0.0
    walls: list[tuple[int, int, Parameters]] = []
    doors: list[tuple[int, int, Parameters]] = []
    measurements: list[tuple[int, int, Parameters]] = []
    fiducials: list[tuple[float, float, Any]] = []
    floors: list[_Floor] = []


class _Lift(msgspec.Struct):
    reference_floor_name: str
    x: float
    y: float
    yaw: float
    width: float
    depth: float
    level_doors: dict[str, Any] = {}


class _Building(msgspec.Struct):
    levels: dict[str, _Level]
    name: str = "building"
    coordinate_system: str = "reference_image"
    reference_level_name: str = ""
    lifts: dict[str, _Lift] = {}


class OpenRmfImporter(Importer):
    """Imports one level of a building: its walls, doors, and the shafts of lifts as blocks, in the fleet's frame."""

    noun = "a building.yaml of Open-RMF"
    suffixes = (".yaml", ".yml")
    sign = r"\A(?=.*^levels:)(?=.*^(building_name|coordinate_system|crowd_sim|graphs|lifts|name):)"
    options: ClassVar[Options] = {
        "--level": {"metavar": "NAME", "help": "the level of a building.yaml; default: the reference level"}
    }
    examples = "  robotteamsim plan import clinic.building.yaml --level L2"

    def read(self, path: Path, **options: Any) -> Imported:
        """See `Importer.read`."""
        data = read_mapping(path, str(path), "a building of Open-RMF")
        try:
            building = msgspec.convert(data, _Building)
        except msgspec.ValidationError as error:
            raise ScenarioError(f"{path}: {error}") from None
        if not building.levels:
            raise ScenarioError(f"{path}: levels: none")
        reference = building.reference_level_name or next(iter(building.levels))
        name = options.get("level", reference)
        for known in (reference, name):
            if known not in building.levels:
                raise ScenarioError(
                    f"{path}: there is no level '{known}'; expected one of {', '.join(building.levels)}"
                    f"{suggestion(known, list(building.levels))}"
                )
        places, notes = _placed(path, building, reference)
        level = _LevelOnMap(f"{path}: levels.{name}", building.levels[name], places[name])
        notes += list(level.notes())
        notes += [f"level {other}: left out; --level {other} imports it" for other in building.levels if other != name]
        blocks, of_lifts = _shafts(path, building, name, places)
        keys = {
            "name": f"{building.name} {name}".strip(),
            "bounds": level.bounds(blocks),
            "walls": list(level.walls()),
            "blocks": blocks,
            "doors": list(level.doors()),
            "materials": (_GLASS,) if level.num_glass else (),
        }
        plan = checked(FloorPlan, keys, place=f"{path}: ")
        return drawn(plan, DrawingRules(doors_m=_ANY_M, windows_m=_ANY_M), (*notes, *of_lifts))


@dataclass(frozen=True)
class _Place:
    """How a level lies in the map: z becomes factor z + shift; x + i y in its drawing, y upwards."""

    factor: complex
    shift: complex
    y_sign: float

    def of(self, x: float, y: float) -> complex:
        """Return a point of the drawing in the map [m]."""
        return self.factor * complex(x, self.y_sign * y) + self.shift


def _placed(path: Path, building: _Building, reference: str) -> tuple[dict[str, _Place], list[str]]:
    """Return how each level lies in the map, and what is doubtful about it. Raises: ScenarioError."""
    if building.coordinate_system not in ("reference_image", "cartesian_meters"):
        text = f"coordinate_system: '{building.coordinate_system}'; expected reference_image or cartesian_meters"
        raise ScenarioError(f"{path}: {text}")
    if building.coordinate_system == "cartesian_meters":
        return dict.fromkeys(building.levels, _Place(1.0 + 0.0j, 0.0j, 1.0)), []
    places, notes = {}, []
    scale_m = _scale_m(path, reference, building.levels[reference])
    drawn_at = {name: _fiducials(level) for name, level in building.levels.items()}
    for name, level in building.levels.items():
        shared = sorted(drawn_at[name].keys() & drawn_at[reference].keys(), key=str)
        if name == reference:
            places[name] = _Place(complex(scale_m), 0.0j, -1.0)
        elif len(shared) >= 2:
            here, there = ([drawn_at[one][key] for key in shared] for one in (name, reference))
            factor, shift = _alignment(here, there)
            places[name] = _Place(scale_m * factor, scale_m * shift, -1.0)
        else:
            places[name] = _Place(complex(_scale_m(path, name, level)), 0.0j, -1.0)
            notes.append(
                f"level {name} shares fewer than two fiducials with {reference}: it lies by its own measurements, "
                "where Open-RMF takes a pixel as a metre"
            )
    return places, notes


def _scale_m(path: Path, name: str, level: _Level) -> float:
    """Return the metres per pixel of a level by its measurements. Raises: ScenarioError: it has none."""
    ratios = []
    for index, (start, end, parameters) in enumerate(level.measurements):
        key = f"{path}: levels.{name}.measurements.{index}"
        (x0, y0), (x1, y1) = _vertex(key, level, start), _vertex(key, level, end)
        edge = _Edge(key, complex(x0, y0), complex(x1, y1), parameters)
        distance_m, pixels = _number(edge, "distance"), abs(edge.end - edge.start)
        if not (distance_m > 0.0 and pixels > 0.0):
            raise ScenarioError(f"{key}: {distance_m:g} m for {pixels:g} pixels; expected more than 0")
        ratios.append(distance_m / pixels)
    if not ratios:
        raise ScenarioError(f"{path}: levels.{name}: has no measurement, so its scale is unknown")
    return float(np.mean(ratios))


def _fiducials(level: _Level) -> dict[Any, complex]:
    """Return the fiducials of a level by name, in pixels with y upwards."""
    return {name: complex(x, -y) for x, y, name in level.fiducials}


def _alignment(here: Sequence[complex], there: Sequence[complex]) -> tuple[complex, complex]:
    """Return factor and shift from the fiducials of a level to those of the reference level, over all pairs."""
    turns, ratios = [], []
    for (a, b), (c, d) in zip(itertools.combinations(here, 2), itertools.combinations(there, 2), strict=True):
        if a != b and c != d:
            turns.append(cmath.exp(1j * (cmath.phase(d - c) - cmath.phase(b - a))))
            ratios.append(abs(d - c) / abs(b - a))
    if not ratios:
        return 1.0 + 0.0j, complex(np.mean(there)) - complex(np.mean(here))
    factor = complex(np.mean(ratios)) * cmath.exp(1j * cmath.phase(sum(turns)))
    return factor, complex(np.mean(np.array(there) - factor * np.array(here)))


def _vertex(key: str, level: _Level, index: int) -> tuple[float, float]:
    """Return x and y of a vertex in the drawing. Raises: ScenarioError: there is none, or it has no place."""
    if not 0 <= index < len(level.vertices):
        raise ScenarioError(f"{key}: vertex {index}; expected 0 to {len(level.vertices) - 1}")
    vertex = level.vertices[index][:2]
    if len(vertex) < 2 or not all(isinstance(one, (int, float)) and math.isfinite(one) for one in vertex):
        raise ScenarioError(f"{key}: vertex {index} is at {vertex}; expected two numbers")
    return float(vertex[0]), float(vertex[1])


def _number(edge: _Edge, name: str, default: float | None = None) -> float:
    """Return a parameter. Raises: ScenarioError: it is missing, or no number."""
    _, value = edge.parameters.get(name, (3, default))
    if not isinstance(value, (int, float)) or not math.isfinite(value):
        raise ScenarioError(f"{edge.key}.{name}: {'missing' if value is None else value}; expected a number")
    return float(value)


class _Edge(NamedTuple):
    """A wall or a door in the map, with the key of its parameters in the file."""

    key: str
    start: complex
    end: complex
    parameters: Parameters


class _LevelOnMap:
    """One level in the map."""

    def __init__(self, key: str, level: _Level, place: _Place) -> None:
        """Place all walls and doors. Raises: ScenarioError: there is no wall, or one without a place."""
        self._key, self._level, self._place = key, level, place
        if not level.walls:
            raise ScenarioError(f"{key}: has no walls, so there is no building to import")
        self._walls = [edge for edge in self._edges("walls", level.walls) if abs(edge.end - edge.start) > 1e-6]
        self._doors = self._edges("doors", level.doors)
        self.num_glass = sum(map(_is_glass, self._walls))
        """Number of walls that are drawn transparent."""

    def _edges(self, name: str, edges: Sequence[tuple[int, int, Parameters]]) -> list[_Edge]:
        found = []
        for index, (start, end, parameters) in enumerate(edges):
            key = f"{self._key}.{name}.{index}"
            found.append(_Edge(key, self._of(key, start), self._of(key, end), parameters))
        return found

    def _of(self, key: str, index: int) -> complex:
        """Return a vertex in the map. Raises: ScenarioError: there is none, or it is too far away."""
        z = self._place.of(*_vertex(key, self._level, index))
        if max(abs(z.real), abs(z.imag)) > _MOST_M:
            raise ScenarioError(f"{key}: vertex {index} is at [{z.real:g}, {z.imag:g}] m; expected at most {_MOST_M:g}")
        return z

    def walls(self) -> Iterator[dict[str, Any]]:
        """Yield the walls, longer at their ends but where a door begins, whose opening has its full width."""
        at_doors = np.array([z for door in self._doors for z in (door.start, door.end)])
        for index, wall in enumerate(self._walls):
            along = (wall.end - wall.start) / abs(wall.end - wall.start)
            before_m, after_m = (
                0.0 if np.any(np.abs(at_doors - z) < WALL_M) else LONGER_M for z in (wall.start, wall.end)
            )
            ends = {"from": _point(wall.start - before_m * along), "to": _point(wall.end + after_m * along)}
            size = {"thickness_m": WALL_M, "height_m": WALL_HEIGHT_M}
            yield {"name": f"wall_{index + 1}", **ends, **size, "material": _GLASS.name if _is_glass(wall) else None}

    def doors(self) -> Iterator[dict[str, Any]]:
        """Yield the leaves of doors, open; a double door is two, from both sides."""
        names: set[str] = set()
        for index, door in enumerate(self._doors):
            found = str(door.parameters.get("name", (1, ""))[1]).strip()
            name = found if found and found not in names else f"{found or 'door'}_{index + 1}"
            names.add(name)
            leaves = [(name, door.start, door.end)]
            if str(door.parameters.get("type", (1, ""))[1]).startswith("double"):
                ratio = _number(door, "right_left_ratio", 1.0)
                middle = door.start + (door.end - door.start) / (1.0 + ratio)
                leaves = [(f"{name}_left", door.start, middle), (f"{name}_right", door.end, middle)]
            elif door.parameters.get("motion_axis", (1, "start"))[1] == "end":
                leaves = [(name, door.end, door.start)]
            for leaf, hinge, other in leaves:
                size = {"thickness_m": LEAF_M, "height_m": LEAF_HEIGHT_M}
                yield {"name": leaf, "from": _point(hinge), "to": _point(other), **size}

    def bounds(self, blocks: Sequence[Block]) -> Bounds:
        """Return the rectangle around everything."""
        points = [z for edge in (*self._walls, *self._doors) for z in (edge.start, edge.end)]
        points += [complex(*corner) for block in blocks for corner in block.polygon]
        for index, floor in enumerate(self._level.floors):
            points += [self._of(f"{self._key}.floors.{index}", vertex) for vertex in floor.vertices]
        low = (min(z.real for z in points) - _MARGIN_M, min(z.imag for z in points) - _MARGIN_M)
        high = (max(z.real for z in points) + _MARGIN_M, max(z.imag for z in points) + _MARGIN_M)
        return Bounds(min=low, max=high)

    def notes(self) -> Iterator[str]:
        """Yield what was guessed or left out."""
        if short := len(self._level.walls) - len(self._walls):
            yield f"{counted(short, 'wall')} without a length: left out"
        if self.num_glass:
            thickness_mm = 1e3 * _GLASS.layers[0].thickness_m
            yield f"{counted(self.num_glass, 'wall')} drawn transparent: taken as {thickness_mm:g} mm of glass"
        if holes := sum(len(floor.holes) for floor in self._level.floors):
            yield f"{counted(holes, 'hole')} in the floor: left out, so robots drive over them"
        if self._doors:
            yield f"{counted(len(self._doors), 'door')}: open at the start, and without a moving leaf"


def _is_glass(wall: _Edge) -> bool:
    return _number(wall, "alpha", 1.0) < 1.0


def _point(z: complex) -> Point:
    return round(z.real, 6), round(z.imag, 6)


def _shafts(path: Path, building: _Building, level: str, places: Mapping[str, _Place]) -> tuple[list[Block], list[str]]:
    """Return the shafts of lifts that stop at a level as blocks, and a note. Raises: ScenarioError."""
    blocks = []
    for name, lift in building.lifts.items():
        if lift.level_doors and level not in lift.level_doors:
            continue
        if lift.reference_floor_name not in places:
            text = f"reference_floor_name: '{lift.reference_floor_name}'"
            raise ScenarioError(f"{path}: lifts.{name}.{text}; expected one of {', '.join(places)}")
        center = places[lift.reference_floor_name].of(lift.x, lift.y)
        half = complex(0.5 * lift.width + SHAFT_M, 0.5 * lift.depth + SHAFT_M)
        corners = (half, complex(-half.real, half.imag), -half, complex(half.real, -half.imag))
        turn = cmath.exp(1j * lift.yaw)
        keys = {"name": f"lift_{name}", "polygon": [_point(center + turn * corner) for corner in corners]}
        blocks.append(checked(Block, keys, place=f"{path}: lifts.{name}: "))
    text = f"{counted(len(blocks), 'lift')}: their shafts are blocks, for a plan has one level"
    return blocks, [text] if blocks else []
