"""Imports drawings of CAD programs, in DXF and DWG."""

import dataclasses
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import shapely

from robotteamsim.arguments import positive_number
from robotteamsim.errors import ScenarioError, UnfinishedImportError
from robotteamsim.formats.drawings import DOOR_WIDTHS_M, OPENINGS, drawn
from robotteamsim.formats.importer import Imported, Importer
from robotteamsim.formats.options import Options
from robotteamsim.scenario.cad import CadDrawing, plan_of_cad, read_cad
from robotteamsim.scenario.cad_layers import Rules, guessed_rules, read_rules, table
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.image_walls import MAX_WALL_THICKNESS_M
from robotteamsim.scenario.map_image import DrawingRules, with_openings
from robotteamsim.wording import counted, printable

_NEAR_M = 0.1
"""Lines of doors this close to each other show one door."""


class CadImporter(Importer):
    """Imports the lines of layers as walls, windows and doors, see `scenario.cad.plan_of_cad`."""

    noun = "a drawing in DXF or DWG"
    suffixes = (".dxf", ".dwg")
    options: ClassVar[Options] = {
        "--layers": {
            "type": Path,
            "metavar": "FILE",
            "help": "table of the layers of a drawing in DXF or DWG; without it, one is guessed and written",
        },
        "--metres-per-unit": {
            "type": positive_number,
            "metavar": "M",
            "help": "scale of a drawing in DXF or DWG; default: the unit it names",
        },
        **OPENINGS,
    }
    examples = "  robotteamsim plan import house.dxf\n  robotteamsim plan import house.dwg --layers house.layers.yaml"

    def read(self, path: Path, **options: Any) -> Imported:
        """See `Importer.read`."""
        drawing = read_cad(path, options.get("metres_per_unit"))
        widths_m, windows_m = options.get("doors"), options.get("windows")
        if given := options.get("layers"):
            rules = read_rules(given, path, drawing.content)
            return dataclasses.replace(_imported(drawing, rules, widths_m, windows_m), files=(given,))
        rules = guessed_rules(drawing.content)
        tables = {"layers": table(rules, path, drawing.content)} if rules else {}
        try:
            found = _imported(drawing, rules, widths_m, windows_m)
        except ScenarioError as error:
            raise UnfinishedImportError(str(error), tables) from None
        return dataclasses.replace(found, notes=(_guesses(drawing, rules), *found.notes), tables=tables)


Widths = tuple[float, float] | None


def _imported(drawing: CadDrawing, rules: Rules, doors_m: Widths, windows_m: Widths) -> Imported:
    """Return the import of a drawing. Args: doors_m, windows_m: as in `DrawingRules`."""
    found = plan_of_cad(drawing, rules)
    has_doors = len(found.door_lines_m) > 0
    gaps = DrawingRules(doors_m=doors_m or (DOOR_WIDTHS_M if has_doors else None), windows_m=windows_m)
    plan, notes = with_openings(found.plan, gaps), found.notes
    if has_doors and doors_m is None:
        plan, num_without = _with_doors_at(plan, found.door_lines_m)
        widths = "{:g} to {:g} m".format(*DOOR_WIDTHS_M)
        missed = f"{counted(num_without, 'part')} of the layers of doors in no gap of {widths} along the axes: no door"
        notes = (*notes, missed) if num_without else notes
    return drawn(plan, gaps, notes)


def _with_doors_at(plan: FloorPlan, lines_m: np.ndarray) -> tuple[FloorPlan, int]:
    """Return a plan with only those doors that some lines show, and how many groups of such lines have no door."""
    shown = shapely.get_parts(shapely.union_all(shapely.buffer(shapely.linestrings(lines_m), 0.5 * _NEAR_M)))
    leaves = shapely.linestrings(np.array([(door.start, door.end) for door in plan.doors]).reshape(-1, 2, 2))
    # The lines of a door begin at either face of the wall, its leaf is in the middle.
    gaps = shapely.buffer(leaves, 0.5 * MAX_WALL_THICKNESS_M, cap_style="flat")
    leaf, group = shapely.STRtree(shown).query(gaps, predicate="intersects")
    kept = [plan.doors[index] for index in sorted(set(leaf.tolist()))]
    doors = tuple(door.model_copy(update={"name": f"door_{number}"}) for number, door in enumerate(kept, 1))
    return plan.model_copy(update={"doors": doors}), len(shown) - len(set(group.tolist()))


def _guesses(drawing: CadDrawing, rules: Rules) -> str:
    """Return what the layers are taken for."""
    layers: dict[str, list[str]] = {}
    for layer, rule in rules.items():
        layers.setdefault(rule.kind, []).append(printable(drawing.content.names[layer]))
    ignored = layers.pop("ignore", [])
    taken = [f"{kind}: {', '.join(names)}" for kind, names in sorted(layers.items())]
    return f"layers by their names: {'; '.join(taken)}" + (
        f"; {counted(len(ignored), 'other')} ignored" if ignored else ""
    )
