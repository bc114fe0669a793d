"""Imports levels of Open-RMF's buildings (`building.yaml`), as rmf_building_map_tools 1.13.0 reads them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from robotteamsim.errors import ScenarioError
from robotteamsim.formats.drawings import num_doors, open_wall_texts
from robotteamsim.formats.importer import Imported, Importer
from robotteamsim.formats.open_rmf_file import (
    LEAF_HEIGHT_M,
    LEAF_M,
    LONGER_M,
    SHORTEST_M,
    WALL_HEIGHT_M,
    WALL_M,
    Building,
    Edge,
    Level,
    Parameters,
    Place,
    Places,
    number,
    read_building,
    rounded,
    vertex_of,
)
from robotteamsim.formats.open_rmf_lifts import lift_notes, lifts_of, shafts_at
from robotteamsim.formats.options import LEVEL, Options
from robotteamsim.formats.side_by_side import DrawnLevel, side_by_side
from robotteamsim.scenario.base import MAX_NAME_CHARACTERS, Point
from robotteamsim.scenario.door_places import misplaced_doors, without_misplaced_doors
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.levels import Opening
from robotteamsim.scenario.materials import GLASS
from robotteamsim.scenario.problems import checked
from robotteamsim.wording import counted
from robotteamsim.world.floor_parts import floor_parts, unreached_texts

_MARGIN_M, _ROBOT_M = 0.5, 0.2
"""Around everything; and radius of the robot for which parts of the floor count as connected."""
_MOST_M = 1e5


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
        building = read_building(path)
        places = Places(path, building)
        names = [options["level"]] if "level" in options else places.to_import()
        drawn = [_DrawnLevel(path, building, places, name, is_alone=len(names) == 1) for name in names]
        title = building.name or building.building_name
        if len(drawn) > 1:
            lifts = list(lifts_of(path, building, places))
            plan = side_by_side(path, title or names[0], [level.drawn for level in drawn], lifts)
            num_lifts = len(plan.passages)
        else:
            plan = drawn[0].drawn.plan.model_copy(update={"name": " ".join(filter(None, (title, names[0])))})
            num_lifts = len(plan.blocks)
        notes = list(dict.fromkeys([*places.notes, *(note for level in drawn for note in level.notes)]))
        if "level" in options:
            left_out = [name for name in building.levels if name not in names]
            notes += [f"level {name}: left out; --level {name} imports it" for name in left_out]
        else:
            notes += lift_notes(building, names)
        parts = floor_parts(plan, _ROBOT_M)
        notes += [*unreached_texts(plan, parts), *open_wall_texts(plan)]
        width_m, height_m = np.subtract(plan.bounds.max, plan.bounds.min)
        counts = [counted(len(plan.levels), "level")] if plan.levels else []
        counts += [counted(len(plan.walls), "wall"), counted(num_lifts, "lift"), counted(num_doors(plan), "door")]
        return Imported(plan, tuple(notes), summary=f"{width_m:g} x {height_m:g} m, {', '.join(counts)}", parts=parts)


class _DrawnLevel:
    """One level as a plan, with what was guessed or left out."""

    def __init__(self, path: Path, building: Building, places: Places, name: str, *, is_alone: bool) -> None:
        """Draw it. Raises: ScenarioError: it cannot be drawn. Args: is_alone: shafts of lifts are blocks."""
        place = f"{path}: levels.{name}"
        level = _LevelOnMap(place, places.level(name), places.of(name))
        shafts = list(shafts_at(path, building, name, places))
        blocks = [shaft.block() for shaft in shafts if is_alone or not shaft.openings]
        lift_walls = [] if is_alone else [wall for shaft in shafts if shaft.openings for wall in shaft.walls()]
        keys = {
            "name": name,
            "bounds": level.bounds([corner for shaft in shafts for corner in shaft.corners]),
            "walls": [*level.walls(), *lift_walls],
            "blocks": blocks,
            "doors": list(level.doors({block["name"] for block in blocks})),
            "materials": (GLASS,) if level.num_glass else (),
        }
        plan = checked(FloorPlan, keys, place=f"{place}: ")
        prefix = "" if is_alone else f"level {name}: "
        self.notes = [f"{prefix}{note}" for note in level.notes()]
        self.notes += [f"{prefix}door {plan.doors[i].name}: {why}; left out" for i, why in misplaced_doors(plan)]
        why = "for a plan of one level has no lifts" if is_alone else "for it has no door here"
        self.notes += [f"{prefix}{block['name']}: its shaft is a block, {why}" for block in blocks]
        elevation_m = places.level(name).elevation
        openings = [*level.holes(), *(tuple(map(rounded, shaft.corners)) for shaft in shafts if shaft.goes_down)]
        self.drawn = DrawnLevel(name, elevation_m, without_misplaced_doors(plan), openings)


class _LevelOnMap:
    """One level in the map."""

    def __init__(self, key: str, level: Level, place: Place) -> None:
        """Place all walls and doors. Raises: ScenarioError: there is no wall, or one without a place."""
        self._key, self._level, self._place = key, level, place
        self._walls, self._doors = self._edges("walls", level.walls), self._edges("doors", level.doors)
        if not self._walls:
            raise ScenarioError(f"{key}: has no walls, so there is no building to import")
        self.num_glass = sum(map(_is_glass, self._walls))
        """Number of walls that are drawn transparent."""

    def _edges(self, name: str, edges: Sequence[tuple[int, int, Parameters]]) -> list[Edge]:
        """Return the edges that have a length."""
        found = []
        for index, (start, end, parameters) in enumerate(edges):
            key = f"{self._key}.{name}.{index}"
            found.append(Edge(key, self._of(key, start), self._of(key, end), parameters))
        return [edge for edge in found if abs(edge.end - edge.start) > SHORTEST_M]

    def _of(self, key: str, index: int) -> complex:
        """Return a vertex in the map. Raises: ScenarioError: there is none, or it is too far away."""
        z = self._place.of(*vertex_of(key, self._level, index))
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
            ends = {"from": rounded(wall.start - before_m * along), "to": rounded(wall.end + after_m * along)}
            size = {"thickness_m": WALL_M, "height_m": WALL_HEIGHT_M}
            yield {"name": f"wall_{index + 1}", **ends, **size, "material": GLASS.name if _is_glass(wall) else None}

    def doors(self, taken: set[str]) -> Iterator[dict[str, Any]]:
        """Yield the leaves of doors, open; a double door is two, from both sides. Args: taken: names of blocks."""
        names = taken | {wall["name"] for wall in self.walls()}
        for index, door in enumerate(self._doors):
            found = str(door.parameters.get("name", (1, ""))[1]).strip()
            if not found.isprintable() or not 0 < len(found) < MAX_NAME_CHARACTERS - len("_right"):
                found = f"door_{index + 1}"
            leaves = [("", door.start, door.end)]
            if str(door.parameters.get("type", (1, ""))[1]).startswith("double"):
                ratio = number(door, "right_left_ratio", 1.0)
                if not ratio > 0.0:
                    raise ScenarioError(f"{door.key}.right_left_ratio: {ratio:g}; expected more than 0")
                middle = door.start + (door.end - door.start) / (1.0 + ratio)
                leaves = [("_left", door.start, middle), ("_right", door.end, middle)]
            while names & {found + side for side, *_ in leaves}:
                found = f"{found}_{index + 1}"[-MAX_NAME_CHARACTERS + len("_right") :]
            names |= {found + side for side, *_ in leaves}
            for side, hinge, other in leaves:
                size = {"thickness_m": LEAF_M, "height_m": LEAF_HEIGHT_M}
                yield {"name": found + side, "from": rounded(hinge), "to": rounded(other), **size}

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
            keys = {"name": "hole", "polygon": [rounded(self._of(key, vertex)) for vertex in hole.vertices]}
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
            thickness_mm = 1e3 * GLASS.layers[0].thickness_m
            yield f"{counted(self.num_glass, 'wall')} drawn transparent: taken as {thickness_mm:g} mm of glass"
        if self._level.holes:
            yield f"{counted(len(self._level.holes), 'hole')} in the floor: robots drive over them"
        if self._doors:
            yield f"{counted(len(self._doors), 'door')}: open at the start; `motion` in the plan would move the leaves"
        else:
            yield "there is no door"


def _is_glass(wall: Edge) -> bool:
    return number(wall, "alpha", 1.0) < 1.0
