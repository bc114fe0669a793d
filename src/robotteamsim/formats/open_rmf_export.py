"""Exports buildings to Open-RMF (`building.yaml`), as rmf_building_map_tools 1.13.0 reads them."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from robotteamsim.formats.exporter import Exported, PlanExporter
from robotteamsim.formats.open_rmf_file import LONGER_M, WALL_HEIGHT_M, WALL_M
from robotteamsim.formats.open_rmf_shafts import FoundShaft, found_shaft
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.floor_plan import Door, FloorPlan, Wall
from robotteamsim.scenario.levels import Level, Passage, level_at
from robotteamsim.scenario.plan import plan_of_level
from robotteamsim.scenario.shapes import Bounds
from robotteamsim.scenario.yaml_text import write
from robotteamsim.setup import Setup
from robotteamsim.wording import counted

_SAME_M = 1e-5
"""Points that are closer are the same: files of Open-RMF are imported with six digits."""
_GLASS_ALPHA = 0.5
_TEXT, _WHOLE, _REAL = 1, 2, 3
_DOUBLE_SLIDING = 2
"""Of rmf_door_msgs, for the doors of lifts."""


class OpenRmfExporter(PlanExporter):
    """Exports levels with walls, doors, floors and lifts, in the frame of the building."""

    help = "write the building of a scenario for Open-RMF"
    suffix = "building.yaml"
    description = """\
Write the building of a scenario, or a floor plan, as a building.yaml of Open-RMF in metres, for
its traffic editor and its simulations. Warnings name what the format does not have."""
    examples = """\
  robotteamsim plan export-open-rmf office_tower --out DIR   DIR/office_tower.building.yaml"""

    def export(self, setup: Setup, **options: Any) -> Exported:
        """See `Exporter.export`."""
        return self.export_plan(setup.plan, **options)

    def export_plan(self, plan: FloorPlan, **options: Any) -> Exported:
        """See `PlanExporter.export_plan`."""
        levels = plan.levels or (Level(name="L1", bounds=plan.bounds, elevation_m=0.0),)
        notes: list[str] = []
        shafts, lifts = _lifts(plan, notes)
        taken = {name for shaft in shafts for name in shaft.walls}
        names = _door_names(plan)
        written = {}
        longer = 0
        for level in levels:
            part = plan_of_level(plan, level)
            drawn = _Drawn(level)
            drawn.add_walls([wall for wall in part.walls if wall.name not in taken], part.doors, _glass(plan))
            drawn.add_doors(part.doors, part.walls, names)
            holes = [opening.polygon for opening in part.openings]
            drawn.add_floor(level.bounds, [hole for hole in holes if not any(one.is_hole(hole) for one in shafts)])
            longer += drawn.num_inexact
            written[level.name] = drawn.keys()
        building = {
            "name": plan.name,
            "coordinate_system": "cartesian_meters",
            "reference_level_name": levels[0].name,
            "levels": written,
            "lifts": lifts,
        }
        if longer:
            notes.append(f"{counted(longer, 'wall')}: up to 0.05 m shorter or longer at an end")
        notes += _notes(plan, taken)
        counts = {"level": len(levels), "wall": sum(len(level["walls"]) for level in written.values())}
        counts |= {"door": sum(len(level["doors"]) for level in written.values()), "lift": len(lifts)}
        summary = ", ".join(counted(count, noun) for noun, count in counts.items())
        return Exported(write(building), summary, tuple(notes))


def _glass(plan: FloorPlan) -> set[str]:
    """Return the names of the materials of a plan whose layers are glass and air."""
    of = {material.name: {layer.of for layer in material.layers} for material in plan.materials}
    return {name for name, layers in of.items() if "glass" in layers and layers <= {"glass", "air"}}


def _door_names(plan: FloorPlan) -> dict[str, str]:
    """Return the names of doors in the file: without that of their level, with which imported ones begin."""
    short = {}
    for door in plan.doors:
        level = level_at(plan.levels, door.start)
        short[door.name] = door.name.removeprefix(f"{level.name}_") if level else door.name
    count = Counter(short.values())
    return {name: found if count[found] == 1 else name for name, found in short.items()}


class _Drawn:
    """A level of the file."""

    def __init__(self, level: Level) -> None:
        self._level = level
        self._vertices: dict[Point, int] = {}
        self._walls: list[list[Any]] = []
        self._doors: list[list[Any]] = []
        self._floors: list[dict[str, Any]] = []
        self._holes: list[dict[str, Any]] = []
        self.num_inexact = 0
        """Number of walls that will be longer or shorter."""

    def keys(self) -> dict[str, Any]:
        """Return it as the file has it."""
        vertices = [[x, y, 0.0, ""] for x, y in self._vertices]
        more: dict[str, Any] = {"floors": self._floors} | ({"holes": self._holes} if self._holes else {})
        elevation = {"elevation": self._level.elevation_m}
        return {**elevation, "vertices": vertices, "walls": self._walls, "doors": self._doors, **more}

    def _vertex(self, point: Point) -> int:
        x, y, _ = self._level.in_building(point)
        # Without the noise of the difference, and without -0.
        return self._vertices.setdefault((round(x, 9) + 0.0, round(y, 9) + 0.0), len(self._vertices))

    def add_walls(self, walls: Sequence[Wall], doors: Sequence[Door], glass: set[str]) -> None:
        """Add walls by the edges that the importer of Open-RMF, and its own tools, make longer."""
        at_doors = np.array([complex(*point) for door in doors for point in (door.start, door.end)])
        for wall in walls:
            start, end = complex(*wall.start), complex(*wall.end)
            along = (end - start) / abs(end - start)
            exact = False
            if abs(end - start) > 2.0 * LONGER_M + _SAME_M:
                start, first = _edge_end(start, along, at_doors)
                end, last = _edge_end(end, -along, at_doors)
                exact = first and last
            self.num_inexact += not exact
            alpha = _GLASS_ALPHA if wall.material in glass else 1.0
            ends = [self._vertex((z.real, z.imag)) for z in (start, end)]
            self._walls.append([*ends, {"texture_name": [_TEXT, "default"], "alpha": [_REAL, alpha]}])

    def add_doors(self, doors: Sequence[Door], walls: Sequence[Wall], names: dict[str, str]) -> None:
        """Add doors."""
        for door, other in _pairs(doors, walls):
            name, end, kind = names[door.name], door.end, "sliding" if door.motion == "slide" else "hinged"
            angle_rad = door.leaf_angle_rad or 0.5 * math.pi
            parameters: dict[str, Any] = {
                "motion_axis": [_TEXT, "start"],
                "motion_degrees": [_REAL, round(math.degrees(abs(angle_rad)), 6)],
                # Above 0, the leaf turns clockwise.
                "motion_direction": [_WHOLE, -1 if angle_rad > 0.0 else 1],
            }
            if other:
                name, end, kind = name.removesuffix("_left"), other.start, f"double_{kind}"
                ratio = math.dist(other.start, other.end) / math.dist(door.start, door.end)
                parameters["right_left_ratio"] = [_REAL, round(ratio, 9)]
            parameters |= {"name": [_TEXT, name], "type": [_TEXT, kind]}
            self._doors.append([self._vertex(door.start), self._vertex(end), parameters])

    def add_floor(self, bounds: Bounds, holes: Sequence[Sequence[Point]]) -> None:
        """Add the floor."""
        (low_x, low_y), (high_x, high_y) = bounds.min, bounds.max
        corners = ((low_x, low_y), (high_x, low_y), (high_x, high_y), (low_x, high_y))
        self._floors.append({"parameters": {}, "vertices": [self._vertex(corner) for corner in corners]})
        self._holes += [{"parameters": {}, "vertices": [self._vertex(corner) for corner in hole]} for hole in holes]


def _edge_end(end: complex, inwards: complex, at_doors: np.ndarray) -> tuple[complex, bool]:
    """Return the end of the edge whose wall ends there; whether it does: walls are longer, but not at doors."""
    if np.any(np.abs(at_doors - end) < _SAME_M):
        return end, True
    shorter = end + LONGER_M * inwards
    if not np.any(np.abs(at_doors - shorter) < WALL_M):
        return shorter, True
    return end, bool(np.any(np.abs(at_doors - end) < WALL_M))


def _pairs(doors: Sequence[Door], walls: Sequence[Wall]) -> Iterator[tuple[Door, Door | None]]:
    """Yield doors; with its other leaf, if both meet on a line and not at the end of a wall."""
    corners = np.array([complex(*point) for wall in walls for point in (wall.start, wall.end)])
    ends = np.array([complex(*door.end) for door in doors])
    paired: set[int] = set()
    for i, door in enumerate(doors):
        if i in paired:
            continue
        other = None
        if not np.any(np.abs(corners - ends[i]) < WALL_M):
            meeting = np.flatnonzero(np.abs(ends - ends[i]) < _SAME_M).tolist()
            other = next((j for j in meeting if j != i and j not in paired and _are_one_door(door, doors[j])), None)
        if other is not None:
            paired.add(other)
        yield door, None if other is None else doors[other]


def _are_one_door(door: Door, other: Door) -> bool:
    """Whether two leaves that meet move alike, with their hinges at the two ends of a line."""
    widths_m = math.dist(door.start, door.end) + math.dist(other.start, other.end)
    return door.motion == other.motion and math.dist(door.start, other.start) > widths_m - _SAME_M


def _lifts(plan: FloorPlan, notes: list[str]) -> tuple[list[FoundShaft], dict[str, Any]]:
    """Return the shafts of lifts whose walls the file does not need, and the lifts in the file."""
    shafts: list[FoundShaft] = []
    lifts: dict[str, Any] = {}
    for passage in plan.passages:
        if passage.kind != "lift":
            continue
        levels = [level for stop in passage.stops if (level := level_at(plan.levels, stop))]
        places = [level.in_building(stop) for level, stop in zip(levels, passage.stops, strict=True)]
        if any(math.dist(place[:2], places[0][:2]) > _SAME_M for place in places):
            notes.append(f"passage {passage.name}: omitted: its stops are not one above another")
            continue
        stops = zip(levels, passage.stops, strict=True)
        found = [found_shaft(stop, plan_of_level(plan, level).walls) for level, stop in stops]
        alike = [shaft for shaft in found if shaft and found[0] and shaft.is_like(found[0])]
        lifts[passage.name] = keys = _lift(passage, places[0], levels)
        if len(alike) == len(found):
            shafts += alike
            keys |= _shaft_keys(alike, levels)
        else:
            why = f"no rectangle of walls {WALL_M:g} m thick is around its stops"
            notes.append(f"passage {passage.name}: a lift without doors, as wide as its stops: {why}")
    return shafts, lifts


def _lift(passage: Passage, place_m: tuple[float, float, float], levels: Sequence[Level]) -> dict[str, Any]:
    x_m, y_m, _ = place_m
    return {
        "x": round(x_m, 9) + 0.0,
        "y": round(y_m, 9) + 0.0,
        "yaw": 0.0,
        "width": 2.0 * passage.radius_m,
        "depth": 2.0 * passage.radius_m,
        "reference_floor_name": levels[0].name,
        "initial_floor_name": levels[0].name,
        "lowest_floor": levels[0].name,
        "highest_floor": levels[-1].name,
        "plugins": True,
        "level_doors": {},
        "doors": {},
    }


def _shaft_keys(shafts: Sequence[FoundShaft], levels: Sequence[Level]) -> dict[str, Any]:
    """Return the size and the doors of a lift."""
    names: dict[tuple[float, float, float, int], str] = {}
    level_doors = {}
    for shaft, level in zip(shafts, levels, strict=True):
        doors = [names.setdefault(door, f"door{len(names) + 1}") for door in shaft.doors()]
        if doors:
            level_doors[level.name] = doors
    doors_of = {
        name: {
            "door_type": _DOUBLE_SLIDING,
            "motion_axis_orientation": 0.5 * math.pi * (side % 2),
            "x": x_m,
            "y": y_m,
            "width": width_m,
        }
        for (x_m, y_m, width_m, side), name in names.items()
    }
    first = shafts[0]
    return {
        "yaw": first.yaw_rad,
        "width": first.width_m,
        "depth": first.depth_m,
        "level_doors": level_doors,
        "doors": doors_of,
    }


def _notes(plan: FloorPlan, taken: set[str]) -> Iterator[str]:
    """Yield what the format does not have."""
    walls = [wall for wall in plan.walls if wall.name not in taken]
    size = (WALL_M, WALL_HEIGHT_M)
    if other := sum((wall.thickness_m, wall.height_m) != size for wall in walls):
        yield f"{counted(other, 'wall')}: {WALL_M:g} m thick and {WALL_HEIGHT_M:g} m high, as all are in Open-RMF"
    if sum(wall.material is not None and wall.material not in _glass(plan) for wall in walls):
        yield "materials: omitted, but that walls of glass are transparent"
    if plan.blocks:
        yield f"blocks: omitted: {counted(len(plan.blocks), 'block')}"
    if any(door.closed or door.kind == "fireproof" for door in plan.doors):
        yield "doors: omitted: which are closed or fireproof"
    if others := [passage.name for passage in plan.passages if passage.kind != "lift"]:
        yield f"passages: stairs and ramps are omitted: {', '.join(others)}"
    if any(level.height_m is not None or level.floor_material is not None for level in plan.levels):
        yield "levels: omitted: height_m and floor_material"
    if plan.bays:
        yield "bays: omitted"
