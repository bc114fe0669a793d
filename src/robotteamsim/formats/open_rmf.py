"""Imports levels of Open-RMF's buildings (`building.yaml`), as rmf_building_map_tools 1.13.0 reads them."""

from __future__ import annotations

import cmath
import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import msgspec
import numpy as np
import shapely

from robotteamsim.errors import ScenarioError
from robotteamsim.formats.importer import Imported, Importer
from robotteamsim.formats.options import LEVEL, Options
from robotteamsim.formats.side_by_side import LIFT, DrawnLevel, DrawnPassage, side_by_side
from robotteamsim.scenario.base import MAX_NAME_CHARACTERS, Point
from robotteamsim.scenario.door_places import misplaced_doors, without_misplaced_doors
from robotteamsim.scenario.floor_plan import Block, FloorPlan
from robotteamsim.scenario.levels import Opening
from robotteamsim.scenario.materials import Layer, Material
from robotteamsim.scenario.problems import checked, suggestion
from robotteamsim.scenario.yaml_text import read_mapping
from robotteamsim.wording import counted
from robotteamsim.world.floor_parts import floor_parts, unreached_texts

WALL_M, WALL_HEIGHT_M, LONGER_M = 0.1, 2.5, 0.05
"""Thickness and height of walls, and by how much they are longer at each end, so that corners close."""
LEAF_M, LEAF_HEIGHT_M = 0.03, 2.2
SHAFT_M = 0.05
"""By how much the shaft of a lift is wider than its cabin, on each side."""
_GLASS = Material(name="glass", layers=(Layer(of="glass", thickness_m=0.006),))
_MARGIN_M, _ROBOT_M = 0.5, 0.2
"""Around everything; and radius of the robot for which parts of the floor count as connected."""
_SHORTEST_M, _MOST_M, _MOST_PIXELS, _MOST_FIDUCIALS = 1e-6, 1e5, 1e9, 1000

Parameters = dict[str, tuple[int, Any]]
"""[code, value] by name; code: 1 string, 2 integer, 3 real, 4 boolean."""


class _Floor(msgspec.Struct):
    """A floor, or a hole in all floors of its level."""

    vertices: list[int]


class _Level(msgspec.Struct):
    """vertices: [x, y, z, name, parameters]. walls, doors, measurements: two vertices, parameters."""

    vertices: list[list[Any]]
    elevation: float = 0.0
    walls: list[tuple[int, int, Parameters]] = []
    doors: list[tuple[int, int, Parameters]] = []
    measurements: list[tuple[int, int, Parameters]] = []
    fiducials: list[tuple[float, float, str | int]] = []
    floors: list[_Floor] = []
    holes: list[_Floor] = []


class _LiftDoor(msgspec.Struct):
    """x, y: from the middle of the cabin [m]."""

    x: float
    y: float
    width: float


class _Lift(msgspec.Struct):
    x: float
    y: float
    yaw: float
    width: float
    depth: float
    reference_floor_name: str = ""
    level_doors: dict[str, list[str]] = {}
    doors: dict[str, _LiftDoor] = {}


class _Building(msgspec.Struct):
    levels: dict[str, _Level]
    name: str = ""
    building_name: str = ""
    coordinate_system: str = "reference_image"
    reference_level_name: str = ""
    lifts: dict[str, _Lift] = {}


class OpenRmfImporter(Importer):
    """Imports the levels of a building with walls, doors and lifts, the first one in the fleet's frame; or one level.

    The shaft of a lift has an opening at each level that it serves; of one level alone, it is a block.
    """

    noun = "a building.yaml of Open-RMF"
    suffixes = (".yaml", ".yml")
    sign = r"\A(?!.*^bounds:)(?=.*^levels:)(?=.*^(building_name|coordinate_system|crowd_sim|graphs|lifts|name):)"
    options: ClassVar[Options] = LEVEL
    examples = "  robotteamsim plan import clinic.building.yaml --level L2"

    def read(self, path: Path, **options: Any) -> Imported:
        """See `Importer.read`."""
        data = read_mapping(path, str(path), "a building of Open-RMF")
        try:
            building = msgspec.convert(data, _Building)
        except msgspec.ValidationError as error:
            raise ScenarioError(f"{path}: {error}") from None
        places = _Places(path, building)
        names = [options["level"]] if "level" in options else places.to_import()
        drawn = [_DrawnLevel(path, building, places, name, is_alone=len(names) == 1) for name in names]
        title = building.name or building.building_name
        if len(drawn) > 1:
            lifts = list(_lifts(path, building, places))
            plan = side_by_side(path, title or names[0], [level.drawn for level in drawn], lifts)
            num_lifts = len(plan.passages)
        else:
            plan = drawn[0].drawn.plan.model_copy(update={"name": " ".join(filter(None, (title, names[0])))})
            num_lifts = len(plan.blocks)
        notes = list(dict.fromkeys([*places.notes, *(note for level in drawn for note in level.notes)]))
        left_out = [name for name in building.levels if name not in names]
        notes += [f"level {name}: left out; --level {name} imports it" for name in left_out]
        parts = floor_parts(plan, _ROBOT_M)
        notes += unreached_texts(plan, parts)
        width_m, height_m = np.subtract(plan.bounds.max, plan.bounds.min)
        counts = [counted(len(plan.levels), "level")] if plan.levels else []
        counts += [counted(len(plan.walls), "wall"), counted(num_lifts, "lift"), counted(len(plan.doors), "door")]
        return Imported(plan, tuple(notes), summary=f"{width_m:g} x {height_m:g} m, {', '.join(counts)}", parts=parts)


class _DrawnLevel:
    """One level as a plan, with what was guessed or left out."""

    def __init__(self, path: Path, building: _Building, places: _Places, name: str, *, is_alone: bool) -> None:
        """Draw it. Raises: ScenarioError: it cannot be drawn. Args: is_alone: shafts of lifts are blocks."""
        place = f"{path}: levels.{name}"
        level = _LevelOnMap(place, places.level(name), places.of(name))
        shafts = list(_shafts(path, building, name, places))
        blocks = [shaft.block() for shaft in shafts if is_alone or not shaft.openings]
        lift_walls = [] if is_alone else [wall for shaft in shafts if shaft.openings for wall in shaft.walls()]
        keys = {
            "name": name,
            "bounds": level.bounds([corner for shaft in shafts for corner in shaft.corners]),
            "walls": [*level.walls(), *lift_walls],
            "blocks": blocks,
            "doors": list(level.doors({block["name"] for block in blocks})),
            "materials": (_GLASS,) if level.num_glass else (),
        }
        plan = checked(FloorPlan, keys, place=f"{place}: ")
        prefix = "" if is_alone else f"level {name}: "
        self.notes = [f"{prefix}{note}" for note in level.notes()]
        self.notes += [f"{prefix}door {plan.doors[i].name}: {why}; left out" for i, why in misplaced_doors(plan)]
        why = "for a plan of one level has no lifts" if is_alone else "for it has no door here"
        self.notes += [f"{prefix}{block['name']}: its shaft is a block, {why}" for block in blocks]
        elevation_m = places.level(name).elevation
        self.drawn = DrawnLevel(name, elevation_m, without_misplaced_doors(plan), list(level.holes()))


@dataclass(frozen=True)
class _Place:
    """How a level lies in the map: z becomes factor z + shift; x + i y in its drawing, y upwards."""

    factor: complex
    shift: complex
    y_sign: float

    def of(self, x: float, y: float) -> complex:
        """Return a point of the drawing in the map [m]."""
        return self.factor * complex(x, self.y_sign * y) + self.shift


class _Places:
    """How the levels of a building lie in the map."""

    def __init__(self, path: Path, building: _Building) -> None:
        """Place none yet. Raises: ScenarioError: no levels, or another coordinate system."""
        if not building.levels:
            raise ScenarioError(f"{path}: levels: none")
        if building.coordinate_system not in ("reference_image", "cartesian_meters"):
            text = f"coordinate_system: '{building.coordinate_system}'; expected reference_image or cartesian_meters"
            raise ScenarioError(f"{path}: {text}")
        self._path, self._building = path, building
        self.reference = building.reference_level_name or next(iter(building.levels))
        self.notes: list[str] = []
        """What is doubtful about the levels that were placed."""

    def to_import(self) -> list[str]:
        """Return the levels that have walls, the reference level first, then from the lowest up; or that level."""
        levels = self._building.levels
        names = [name for name in levels if levels[name].walls]
        names.sort(key=lambda name: (name != self.reference, levels[name].elevation))
        self.notes += [f"level {name}: has no walls" for name in levels if names and name not in names]
        return names or [self.reference]

    def level(self, name: str) -> _Level:
        """Return a level. Raises: ScenarioError: there is none of this name."""
        levels = self._building.levels
        if name not in levels:
            known = f"expected one of {', '.join(levels)}{suggestion(name, list(levels))}"
            raise ScenarioError(f"{self._path}: there is no level '{name}'; {known}")
        return levels[name]

    def of(self, name: str) -> _Place:
        """Return the place of a level. Raises: ScenarioError: there is none, or its scale is unknown."""
        for known in (self.reference, name):
            self.level(known)
        if self._building.coordinate_system == "cartesian_meters":
            return _Place(1.0 + 0.0j, 0.0j, 1.0)
        if name == self.reference:
            return _Place(complex(self._scale_m(name)), 0.0j, -1.0)
        drawn, expected = (self._fiducials(one) for one in (name, self.reference))
        if shared := sorted(drawn.keys() & expected.keys(), key=str):
            factor, shift = _alignment([drawn[key] for key in shared], [expected[key] for key in shared])
            if factor:
                scale_m = self._scale_m(self.reference)
                return _Place(scale_m * factor, scale_m * shift, -1.0)
        self.notes.append(
            f"level {name} shares fewer than two fiducials with {self.reference}: it lies by its own measurements, "
            "where Open-RMF takes a pixel as a metre"
        )
        return _Place(complex(self._scale_m(name)), 0.0j, -1.0)

    def _scale_m(self, name: str) -> float:
        """Return the metres per pixel of a level by its measurements. Raises: ScenarioError: it has none."""
        level, ratios = self.level(name), []
        for index, (start, end, parameters) in enumerate(level.measurements):
            key = f"{self._path}: levels.{name}.measurements.{index}"
            edge = _Edge(key, complex(*_vertex(key, level, start)), complex(*_vertex(key, level, end)), parameters)
            distance_m, pixels = _number(edge, "distance"), abs(edge.end - edge.start)
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
            if not max(abs(x), abs(y)) <= _MOST_PIXELS:
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


def _vertex(key: str, level: _Level, index: int) -> tuple[float, float]:
    """Return x and y of a vertex in the drawing. Raises: ScenarioError: there is none, or it has no place."""
    if not 0 <= index < len(level.vertices):
        raise ScenarioError(f"{key}: vertex {index}; expected 0 to {len(level.vertices) - 1}")
    vertex = level.vertices[index][:2]
    if len(vertex) < 2 or not all(map(_is_number, vertex)):
        raise ScenarioError(f"{key}: vertex {index} is at {vertex}; expected two numbers")
    return float(vertex[0]), float(vertex[1])


def _number(edge: _Edge, name: str, default: float | None = None) -> float:
    """Return a parameter. Raises: ScenarioError: it is missing, or no number."""
    _, value = edge.parameters.get(name, (3, default))
    if not _is_number(value):
        raise ScenarioError(f"{edge.key}.{name}: {'missing' if value is None else value}; expected a number")
    return float(value)


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


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
        self._walls, self._doors = self._edges("walls", level.walls), self._edges("doors", level.doors)
        if not self._walls:
            raise ScenarioError(f"{key}: has no walls, so there is no building to import")
        self.num_glass = sum(map(_is_glass, self._walls))
        """Number of walls that are drawn transparent."""

    def _edges(self, name: str, edges: Sequence[tuple[int, int, Parameters]]) -> list[_Edge]:
        """Return the edges that have a length."""
        found = []
        for index, (start, end, parameters) in enumerate(edges):
            key = f"{self._key}.{name}.{index}"
            found.append(_Edge(key, self._of(key, start), self._of(key, end), parameters))
        return [edge for edge in found if abs(edge.end - edge.start) > _SHORTEST_M]

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

    def doors(self, taken: set[str]) -> Iterator[dict[str, Any]]:
        """Yield the leaves of doors, open; a double door is two, from both sides. Args: taken: names of blocks."""
        names = taken | {wall["name"] for wall in self.walls()}
        for index, door in enumerate(self._doors):
            found = str(door.parameters.get("name", (1, ""))[1]).strip()
            if not found.isprintable() or not 0 < len(found) < MAX_NAME_CHARACTERS - len("_right"):
                found = f"door_{index + 1}"
            leaves = [("", door.start, door.end)]
            if str(door.parameters.get("type", (1, ""))[1]).startswith("double"):
                ratio = _number(door, "right_left_ratio", 1.0)
                if not ratio > 0.0:
                    raise ScenarioError(f"{door.key}.right_left_ratio: {ratio:g}; expected more than 0")
                middle = door.start + (door.end - door.start) / (1.0 + ratio)
                leaves = [("_left", door.start, middle), ("_right", door.end, middle)]
            while names & {found + side for side, *_ in leaves}:
                found = f"{found}_{index + 1}"[-MAX_NAME_CHARACTERS + len("_right") :]
            names |= {found + side for side, *_ in leaves}
            for side, hinge, other in leaves:
                size = {"thickness_m": LEAF_M, "height_m": LEAF_HEIGHT_M}
                yield {"name": found + side, "from": _point(hinge), "to": _point(other), **size}

    def bounds(self, corners: Sequence[complex]) -> dict[str, Point]:
        """Return the rectangle around everything. Args: corners: of the shafts of lifts."""
        points = [z for edge in (*self._walls, *self._doors) for z in (edge.start, edge.end)]
        points += corners
        for name, polygons in (("floors", self._level.floors), ("holes", self._level.holes)):
            for index, polygon in enumerate(polygons):
                points += [self._of(f"{self._key}.{name}.{index}", vertex) for vertex in polygon.vertices]
        low = (min(z.real for z in points) - _MARGIN_M, min(z.imag for z in points) - _MARGIN_M)
        high = (max(z.real for z in points) + _MARGIN_M, max(z.imag for z in points) + _MARGIN_M)
        return {"min": low, "max": high}

    def holes(self) -> Iterator[tuple[Point, ...]]:
        """Yield the holes in the floor. Raises: ScenarioError: one is no polygon."""
        for index, hole in enumerate(self._level.holes):
            key = f"{self._key}.holes.{index}"
            keys = {"name": "hole", "polygon": [_point(self._of(key, vertex)) for vertex in hole.vertices]}
            yield checked(Opening, keys, place=f"{key}: ").polygon

    def notes(self) -> Iterator[str]:
        """Yield what was guessed or left out."""
        for what, edges, kept in (
            ("wall", self._level.walls, self._walls),
            ("door", self._level.doors, self._doors),
        ):
            if short := len(edges) - len(kept):
                yield f"{counted(short, what)} without a length: left out"
        if self.num_glass:
            thickness_mm = 1e3 * _GLASS.layers[0].thickness_m
            yield f"{counted(self.num_glass, 'wall')} drawn transparent: taken as {thickness_mm:g} mm of glass"
        if self._level.holes:
            yield f"{counted(len(self._level.holes), 'hole')} in the floor: robots drive over them"
        if self._doors:
            yield f"{counted(len(self._doors), 'door')}: open at the start; `motion` in the plan would move the leaves"


def _is_glass(wall: _Edge) -> bool:
    return _number(wall, "alpha", 1.0) < 1.0


def _point(z: complex) -> Point:
    return round(z.real, 6), round(z.imag, 6)


@dataclass(frozen=True)
class _Shaft:
    """The shaft of a lift in the map.

    turn, half: direction of its first side, and half its sides, x + i y [m].
    openings:   of its doors at a level, from the middle of the cabin; none if it does not stop there.
    """

    key: str
    name: str
    center: complex
    turn: complex
    half: complex
    openings: tuple[_LiftDoor, ...]

    @property
    def corners(self) -> list[complex]:
        """Its corners, counter-clockwise [m]."""
        x, y = self.half.real, self.half.imag
        return [self.center + self.turn * complex(*corner) for corner in ((x, y), (-x, y), (-x, -y), (x, -y))]

    def block(self) -> dict[str, Any]:
        """Return it as a block."""
        return {"name": f"lift {self.name}", "polygon": list(map(_point, self.corners))}

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
                keys = dict(zip(("from", "to"), map(_point, ends), strict=True))
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
    parts = [part for part in shapely.get_parts(cut) if part.length > _SHORTEST_M]
    return [(part.bounds[0], part.bounds[2]) for part in parts]


def _shafts(path: Path, building: _Building, level: str, places: _Places) -> Iterator[_Shaft]:
    """Yield the shafts of lifts at a level, from the lowest to the highest that they serve. Raises: ScenarioError."""
    for name, lift in building.lifts.items():
        served = [one for one, doors in lift.level_doors.items() if doors and one in building.levels]
        served_m = [building.levels[one].elevation for one in served]
        if not served_m or not min(served_m) <= building.levels[level].elevation <= max(served_m):
            continue
        center = places.of(lift.reference_floor_name or places.reference).of(lift.x, lift.y)
        half = complex(0.5 * lift.width + SHAFT_M, 0.5 * lift.depth + SHAFT_M)
        openings = tuple(lift.doors[door] for door in lift.level_doors.get(level, ()) if door in lift.doors)
        shaft = _Shaft(f"{path}: lifts.{name}", name, center, cmath.exp(1j * lift.yaw), half, openings)
        checked(Block, shaft.block(), place=f"{shaft.key}: ")
        yield shaft


def _lifts(path: Path, building: _Building, places: _Places) -> Iterator[DrawnPassage]:
    """Yield the lifts, each with a stop in the middle of its cabin at each level at which it has doors."""
    found: dict[str, dict[str, Point]] = {}
    for level in building.levels:
        for shaft in _shafts(path, building, level, places):
            if shaft.openings:
                found.setdefault(shaft.name, {})[level] = _point(shaft.center)
    for name, stops in found.items():
        yield DrawnPassage({"name": name, **LIFT}, stops)
