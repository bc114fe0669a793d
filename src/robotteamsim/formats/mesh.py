"""Exports buildings as meshes: glTF, Wavefront OBJ and COLLADA."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import shapely

from robotteamsim import palette
from robotteamsim.errors import ScenarioError
from robotteamsim.formats.exporter import Exported, PlanExporter
from robotteamsim.formats.mesh_files import Part, collada_of, glb_of, obj_of
from robotteamsim.formats.options import Options
from robotteamsim.scenario.floor_plan import Door, FloorPlan
from robotteamsim.scenario.plan import plan_of_level, solids
from robotteamsim.setup import Setup
from robotteamsim.wording import counted

FLOOR_M = 0.2
"""Thickness of floors, below their elevation."""

_GRID_M = 1e-4
"""Corners lie on this grid: in single precision, as in glTF, they stay distinct."""
_FARTHEST_M = 1000.0
"""Buildings farther from [0, 0] are moved, for the same reason."""

_COLOURS = {
    "floor": palette.BAY,
    "walls": palette.LIT_SOLIDS["wall"],
    "blocks": palette.LIT_SOLIDS["block"],
    "pillars": palette.LIT_SOLIDS["pillar"],
    "doors": palette.LIT_DOORS["normal"],
    "fireproof_doors": palette.LIT_DOORS["fireproof"],
}
"""By kind of element, and so the names of meshes."""


class MeshExporter(PlanExporter):
    """Exports the building with its levels one above another, as one mesh per kind of element and level."""

    help = "write the building of a scenario as a mesh"
    suffix = "glb"
    description = """\
Write the building of a scenario, or a floor plan, as a mesh for Blender, Unity, Isaac Sim and
other programs: floors, walls, blocks, pillars and door leaves at the start, levels one above
another, in metres. OBJ and COLLADA have z up, glTF (glb) has y up, as it demands."""
    examples = """\
  robotteamsim plan export-mesh office_tower --out DIR       DIR/office_tower.glb
  robotteamsim plan export-mesh plan.yaml --out DIR --format obj"""
    options: ClassVar[Options] = {
        "--format": {"choices": ("glb", "obj", "dae"), "help": "glTF, Wavefront OBJ or COLLADA; default glb"}
    }

    def export(self, setup: Setup, **options: Any) -> Exported:
        """See `Exporter.export`."""
        return self.export_plan(setup.plan, **options)

    def export_plan(self, plan: FloorPlan, **options: Any) -> Exported:
        """See `PlanExporter.export_plan`. Raises: ScenarioError: there is nothing to export."""
        suffix = options.get("format", self.suffix)
        storeys = list(_storeys(plan))
        notes = [f"{key}: omitted: they have no shape" for key in ("bays", "passages") if getattr(plan, key)]
        shift = _shift_m(storeys)
        if any(shift):
            offset = f"[{shift[0]:g}, {shift[1]:g}]"
            notes.append(f"moved by {offset} m: meshes are too coarse so far away, in single precision")
        parts = [part for storey in storeys for part in _parts(storey, shift)]
        if not parts:
            raise ScenarioError(f"{plan.name}: openings: leave no floor, and there is nothing else to export")
        others: dict[str, str] = {}
        content: str | bytes
        if suffix == "obj":
            materials = f"{re.sub('[^A-Za-z0-9_-]', '_', plan.name)}.mtl"
            content, others[materials] = obj_of(parts, materials)
        else:
            content = collada_of(parts) if suffix == "dae" else glb_of(parts)
        summary = counted(sum(len(part.mesh.faces) for part in parts), "triangle")
        return Exported(content, summary, tuple(notes), others, suffix)


@dataclass(frozen=True)
class _Storey:
    """A level, or the whole plan without levels. place_m: where [0, 0] of the plan is in the building."""

    ending: str
    plan: FloorPlan
    place_m: tuple[float, float, float]


def _storeys(plan: FloorPlan) -> Iterator[_Storey]:
    for level in plan.levels:
        yield _Storey(f"_{level.name}", plan_of_level(plan, level), level.in_building((0.0, 0.0)))
    if not plan.levels:
        yield _Storey("", plan, (0.0, 0.0, 0.0))


def _shift_m(storeys: Sequence[_Storey]) -> tuple[float, float]:
    """Return by which whole metres a building is moved to the origin; 0 if it is near enough."""
    corners = np.array(
        [[point, np.array(storey.place_m[:2])] for storey in storeys for point in _corners(storey.plan)]
    ).sum(axis=1)
    if np.abs(corners).max() <= _FARTHEST_M:
        return 0.0, 0.0
    x_m, y_m = corners.min(axis=0)
    return -math.floor(x_m), -math.floor(y_m)


def _corners(plan: FloorPlan) -> tuple[tuple[float, float], tuple[float, float]]:
    return plan.bounds.min, plan.bounds.max


def _parts(storey: _Storey, shift_m: tuple[float, float]) -> Iterator[Part]:
    """Yield the meshes of a storey, which do not overlap: where solids do, the higher one remains."""
    plan, (x_m, y_m, floor_m) = storey.plan, storey.place_m
    prisms: dict[str, list[tuple[shapely.Geometry, float, float]]] = {kind: [] for kind in _COLOURS}
    holes = shapely.union_all([shapely.Polygon(opening.polygon) for opening in plan.openings], grid_size=_GRID_M)
    whole = shapely.box(*plan.bounds.min, *plan.bounds.max)
    prisms["floor"].append((shapely.difference(whole, holes, grid_size=_GRID_M), -FLOOR_M, 0.0))
    groups: dict[tuple[float, str], list[shapely.Polygon]] = {}
    for solid in solids(plan):
        is_fireproof = isinstance(solid.element, Door) and solid.element.kind == "fireproof"
        kind = "fireproof_doors" if is_fireproof else f"{solid.kind}s"
        groups.setdefault((solid.element.height_m, kind), []).append(solid.polygon)
    taken: shapely.Geometry = shapely.Polygon()
    for (height_m, kind), footprints in sorted(groups.items(), key=lambda group: group[0][0], reverse=True):
        union = shapely.union_all(footprints, grid_size=_GRID_M)
        prisms[kind].append((shapely.difference(union, taken, grid_size=_GRID_M), 0.0, height_m))
        taken = shapely.union(taken, union, grid_size=_GRID_M)
    for kind, colour in _COLOURS.items():
        placed = [
            (polygon, (x_m + shift_m[0], y_m + shift_m[1], floor_m + low_m), high_m - low_m)
            for area, low_m, high_m in prisms[kind]
            for polygon in shapely.get_parts(area)
            if not polygon.is_empty
        ]
        if placed:
            yield Part.of_prisms(kind + storey.ending, kind, colour, placed)
