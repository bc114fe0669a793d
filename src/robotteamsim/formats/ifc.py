"""Imports storeys of buildings in IFC 2x3, 4 and 4.3."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from robotteamsim.errors import ScenarioError
from robotteamsim.formats.ifc_file import IfcBuilding, schema_mistakes
from robotteamsim.formats.ifc_storey import StoreyPlan, has_doors, has_walls
from robotteamsim.formats.importer import Imported, Importer
from robotteamsim.formats.options import LEVEL, Options
from robotteamsim.scenario.base import MAX_NAME_CHARACTERS
from robotteamsim.scenario.door_places import misplaced_doors
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.problems import checked, suggestion
from robotteamsim.wording import counted, printable
from robotteamsim.world.floor_parts import floor_parts, part_texts

_MARGIN_M, _ROBOT_M = 0.5, 0.2
"""Around everything; and radius of the robot for which parts of the floor count as connected."""


class IfcImporter(Importer):
    """Imports one storey of a building: its walls, columns and doors, in the coordinates of the file."""

    noun = "a building in IFC"
    suffixes = (".ifc",)
    sign = r"\A\s*ISO-10303-21;.*FILE_SCHEMA\s*\(\s*\(\s*'IFC"
    options: ClassVar[Options] = LEVEL
    examples = "  robotteamsim plan import hospital.ifc --level 'Level 1'"

    def read(self, path: Path, **options: Any) -> Imported:
        """See `Importer.read`."""
        try:
            return self._read(path, **options)
        except (ScenarioError, ImportError):
            raise
        except Exception:  # an attribute that the schema requires is missing, or of another class
            if not (mistakes := schema_mistakes(path)):
                raise
        more = f", and {counted(len(mistakes) - 1, 'further mistake')}" if len(mistakes) > 1 else ""
        raise ScenarioError(f"{path}: breaks the schema of IFC: {mistakes[0]}{more}")

    def _read(self, path: Path, **options: Any) -> Imported:
        building = IfcBuilding(path)
        name = options.get("level") or _first(building)
        if name not in building.storeys:
            known = list(building.storeys)
            text = f"expected one of {', '.join(known)}{suggestion(name, known)}"
            raise ScenarioError(f"{path}: there is no storey '{printable(name)}'; {text}")
        found = read_storey(path, building, name)
        others = [
            f"storey {other}: left out; --level '{other}' imports it" for other in building.storeys if other != name
        ]
        return Imported(found.plan, (*building.notes, *found.notes, *others), summary=found.summary, parts=found.parts)


def read_storey(path: Path, building: IfcBuilding, name: str) -> Imported:
    """Return any storey of a building; all storeys have the same coordinates.

    Raises: ScenarioError: it has no walls, or cannot be a plan.
    """
    storey = building.storeys[name]
    place = f"{path}: #{storey.entity.id()} (storey {name})"
    found = StoreyPlan(building, storey)
    if not (found.walls or found.blocks):
        raise ScenarioError(f"{place}: has no walls between its floor, at {storey.floor_m:g} m, and 2 m above it")
    offset_m = tuple(building.shift_m.tolist())
    keys = {
        "name": printable(f"{path.stem} {name}")[:MAX_NAME_CHARACTERS],
        "bounds": _bounds([*found.walls, *found.doors], found.blocks),
        "walls": found.walls,
        "blocks": found.blocks,
        "doors": found.doors,
        "materials": found.materials,
        "drawing_offset_m": offset_m if any(offset_m) else None,
    }
    drawn = checked(FloorPlan, keys, place=f"{place}: ")
    notes = list(found.notes())
    misplaced = dict(misplaced_doors(drawn))
    notes += [f"door {drawn.doors[i].name}: {why}; left out" for i, why in misplaced.items()]
    doors = tuple(door for i, door in enumerate(drawn.doors) if i not in misplaced)
    plan = drawn.model_copy(update={"doors": doors})
    parts = floor_parts(plan, _ROBOT_M)
    notes += [f"no door leads from the largest part of the floor to {part}" for part in part_texts(parts[1:])]
    width_m, height_m = np.subtract(plan.bounds.max, plan.bounds.min).round(3)
    pillars = sum(block.kind == "pillar" for block in plan.blocks)
    num_doors = len({door.name.removesuffix("_left").removesuffix("_right") for door in plan.doors})
    counts = (
        f"{counted(found.num_walls, 'straight wall')} in {counted(len(plan.walls), 'piece')}",
        counted(len(plan.blocks) - pillars, "block"),
        counted(pillars, "column"),
        counted(num_doors, "door"),
    )
    summary = f"storey {name}, {width_m:g} x {height_m:g} m, {', '.join(counts)}"
    if any(offset_m):
        summary += "; [0, 0] is [{:.10g}, {:.10g}] m in the file".format(*offset_m)
    return Imported(plan, tuple(notes), summary=summary, parts=parts)


def _first(building: IfcBuilding) -> str:
    """Return the lowest storey with a door, else the lowest with walls, else the lowest."""
    for test in (has_doors, has_walls):
        for name, storey in building.storeys.items():
            if test(building, storey):
                return name
    return next(iter(building.storeys))


def _bounds(lines: Sequence[dict[str, Any]], blocks: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Return the rectangle around everything."""
    points = [line[end] for line in lines for end in ("from", "to")]
    points += [corner for block in blocks for corner in block["polygon"]]
    low, high = np.min(points, axis=0) - _MARGIN_M, np.max(points, axis=0) + _MARGIN_M
    return {"min": low.round(6).tolist(), "max": high.round(6).tolist()}
