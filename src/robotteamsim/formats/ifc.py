"""Imports buildings in IFC 2x3, 4 and 4.3."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from robotteamsim.errors import ScenarioError
from robotteamsim.formats.drawings import num_doors, open_wall_texts
from robotteamsim.formats.ifc_file import IfcBuilding, Rise, listed, schema_mistakes
from robotteamsim.formats.ifc_rises import joined, rises_at
from robotteamsim.formats.ifc_storey import FLOOR_M, HEAD_M, StoreyNotes, StoreyPlan, has_doors, has_walls, on_none
from robotteamsim.formats.importer import Imported, Importer
from robotteamsim.formats.options import LEVEL, Options
from robotteamsim.formats.side_by_side import DrawnLevel, side_by_side
from robotteamsim.scenario.base import MAX_NAME_CHARACTERS
from robotteamsim.scenario.door_places import misplaced_doors, without_misplaced_doors
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.problems import checked, suggestion
from robotteamsim.wording import counted, described, place_of, printable
from robotteamsim.world.floor_parts import floor_parts, unreached_texts

_MARGIN_M, _ROBOT_M = 0.5, 0.2
"""Around everything; and radius of the robot for which parts of the floor count as connected."""


class IfcImporter(Importer):
    """Imports the storeys of a building with walls, columns and doors, the first one in the coordinates of the file."""

    noun = "a building in IFC"
    suffixes = (".ifc",)
    sign = r"\A\s*ISO-10303-21;.*FILE_SCHEMA\s*\(\s*\(\s*'IFC"
    options: ClassVar[Options] = LEVEL
    examples = "  robotteamsim plan import hospital.ifc --level 'Level 1'"

    def read(self, path: Path, **options: Any) -> Imported:
        """See `Importer.read`."""
        try:
            with np.errstate(all="ignore"):  # of directions without a length
                return self._read(path, **options)
        except (ScenarioError, ImportError):
            raise
        except Exception as error:  # an attribute that the schema requires is missing, or of another class
            if not (mistakes := schema_mistakes(path)):
                if not place_of(error)[0].startswith("ifcopenshell"):
                    raise
                raise ScenarioError(f"{path}: cannot be read as IFC: {described(error)}") from error
        more = f", and {counted(len(mistakes) - 1, 'further mistake')}" if len(mistakes) > 1 else ""
        raise ScenarioError(f"{path}: breaks the schema of IFC: {mistakes[0]}{more}")

    def _read(self, path: Path, **options: Any) -> Imported:
        building = IfcBuilding(path)
        names, others = _to_import(building)
        if "level" in options:
            names = [options["level"]]
            others = [
                f"storey {one}: left out; --level '{one}' imports it" for one in building.storeys if one not in names
            ]
        if names[0] not in building.storeys:
            known = list(building.storeys)
            text = f"expected one of {', '.join(known)}{suggestion(names[0], known)}"
            raise ScenarioError(f"{path}: there is no storey '{printable(names[0])}'; {text}")
        notes = StoreyNotes(building)
        drawn = [_drawn(path, building, name, notes) for name in names]
        plan = drawn[0].plan
        if "level" in options:
            if rises := rises_at(building, building.storeys[names[0]].floor_m):
                left_out = listed([rise.element for rise in rises])
                others.append(f"a plan of one storey has no passages; not joined to others: {left_out}")
        else:
            if lost := on_none(building, [building.storeys[name] for name in names]):
                others.append(f"above heads or below the floor of each storey, left out: {listed(lost)}")
            found = joined(building, drawn, _ROBOT_M)
            others += found.notes
        if len(drawn) > 1:
            plan = side_by_side(path, printable(path.stem)[:MAX_NAME_CHARACTERS], found.levels, found.passages)
            if any(passage.kind == "stairs" for passage in plan.passages):
                others.append("stairs are for people; robots take those with `robots: true` in the plan")
        offset_m = tuple(building.shift_m.tolist())
        if any(offset_m):
            plan = plan.model_copy(update={"drawing_offset_m": offset_m})
        parts = floor_parts(plan, _ROBOT_M)
        all_notes = (*building.notes, *notes, *others, *unreached_texts(plan, parts), *open_wall_texts(plan))
        return Imported(plan, all_notes, summary=_summary(plan, names, notes.num_walls), parts=parts)


def _drawn(path: Path, building: IfcBuilding, name: str, notes: StoreyNotes) -> DrawnLevel:
    """Return a storey of a building; all storeys have the same coordinates.

    Raises: ScenarioError: it has no walls, or cannot be a plan.
    """
    storey = building.storeys[name]
    place = f"{path}: #{storey.entity.id()} (storey {name})"
    found = StoreyPlan(building, storey, notes)
    if not (found.walls or found.blocks):
        raise ScenarioError(f"{place}: has no walls between its floor, at {storey.floor_m:g} m, and 2 m above it")
    keys = {
        "name": printable(f"{path.stem} {name}")[:MAX_NAME_CHARACTERS],
        "bounds": _bounds([*found.walls, *found.doors], found.blocks, rises_at(building, storey.floor_m)),
        "walls": found.walls,
        "blocks": found.blocks,
        "doors": found.doors,
        "materials": notes.materials.used_by([*found.walls, *found.blocks]),
    }
    plan = checked(FloorPlan, keys, place=f"{place}: ")
    notes.misplaced += [f"door {plan.doors[i].name}: {why}; left out" for i, why in misplaced_doors(plan)]
    return DrawnLevel(name, round(storey.floor_m, 6), without_misplaced_doors(plan))


def _to_import(building: IfcBuilding) -> tuple[list[str], list[str]]:
    """Return the storeys to import, the lowest with a door first, then from the lowest up; and notes on the others."""
    names: dict[float, str] = {}
    notes = []
    above_m = [storey.floor_m for storey in building.storeys.values()][1:]
    for (name, storey), next_m in zip(building.storeys.items(), [*above_m, math.inf], strict=True):
        at_m = round(storey.floor_m, 6)
        if not has_walls(building, storey):
            notes.append(f"storey {name}: left out; it has no walls")
        elif at_m in names:  # and has the same walls
            notes.append(f"storey {name}: left out; it is at the height of {names[at_m]}")
        elif FLOOR_M < next_m - at_m < HEAD_M and not has_doors(building, storey):
            text = f"it has no door, and is less than {HEAD_M:g} m high"
            notes.append(f"storey {name}: left out; {text}; --level '{name}' imports it")
        else:
            names[at_m] = name
    found = list(names.values()) or list(building.storeys)[:1]
    first = next((name for name in found if has_doors(building, building.storeys[name])), found[0])
    return [first, *(name for name in found if name != first)], notes


def _summary(plan: FloorPlan, names: Sequence[str], num_walls: int) -> str:
    """Return the size of an import. Args: num_walls: of straight ones, before openings interrupt them."""
    width_m, height_m = np.subtract(plan.bounds.max, plan.bounds.min).round(3)
    pillars = sum(block.kind == "pillar" for block in plan.blocks)
    counts = [
        f"{counted(num_walls, 'straight wall')} in {counted(len(plan.walls), 'piece')}",
        counted(len(plan.blocks) - pillars, "block"),
        counted(pillars, "column"),
        counted(num_doors(plan), "door"),
    ]
    counts += [counted(len(plan.passages), "passage")] if plan.levels else []
    storeys = f"storey {names[0]}" if len(names) == 1 else f"{len(names)} storeys"
    summary = f"{storeys}, {width_m:g} x {height_m:g} m, {', '.join(counts)}"
    if plan.drawing_offset_m:
        summary += "; [0, 0] is [{:.10g}, {:.10g}] m in the file".format(*plan.drawing_offset_m)
    return summary


def _bounds(lines: Sequence[dict[str, Any]], blocks: Sequence[dict[str, Any]], rises: Sequence[Rise]) -> dict[str, Any]:
    """Return the rectangle around everything, with room for the stops of stairs."""
    points = [line[end] for line in lines for end in ("from", "to")]
    points += [corner for block in blocks for corner in block["polygon"]]
    low, high = np.min(points, axis=0) - _MARGIN_M, np.max(points, axis=0) + _MARGIN_M
    for rise in rises:
        corners = np.concatenate([mesh.corners.reshape(-1, 3) for mesh in rise.meshes])[:, :2]
        low = np.minimum(low, corners.min(axis=0) - 2.0 * _MARGIN_M)
        high = np.maximum(high, corners.max(axis=0) + 2.0 * _MARGIN_M)
    return {"min": low.round(6).tolist(), "max": high.round(6).tolist()}
