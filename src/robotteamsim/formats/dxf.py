"""Imports drawings of CAD programs in DXF."""

from pathlib import Path
from typing import Any, ClassVar

from robotteamsim.arguments import positive_number
from robotteamsim.formats.drawings import OPENINGS, drawn
from robotteamsim.formats.importer import Imported, Importer
from robotteamsim.formats.options import Options
from robotteamsim.scenario.dxf import DxfRules, import_dxf
from robotteamsim.scenario.map_image import DrawingRules, with_openings


class DxfImporter(Importer):
    """Imports lines of the chosen layers as walls, see `scenario.dxf.import_dxf`."""

    noun = "a DXF file"
    suffixes = (".dxf",)
    options: ClassVar[Options] = {
        "--layer": {
            "action": "append",
            "metavar": "NAME",
            "help": "a layer of a DXF file whose lines are walls; repeatable; without it, the layers are listed",
        },
        "--metres-per-unit": {
            "type": positive_number,
            "metavar": "M",
            "help": "scale of a DXF file; default: the unit it names",
        },
        "--wall-thickness": {
            "type": positive_number,
            "metavar": "M",
            "help": "of lines of a DXF file that are no faces and have no width; default 0.1",
        },
        **OPENINGS,
    }
    examples = "  robotteamsim plan import house.dxf --layer WALLS --layer PILLARS --wall-thickness 0.12"

    def read(self, path: Path, **options: Any) -> Imported:
        """See `Importer.read`."""
        thickness_m = options.get("wall_thickness", DxfRules(()).wall_thickness_m)
        found = import_dxf(path, DxfRules(options.get("layer", ()), options.get("metres_per_unit"), thickness_m))
        rules = DrawingRules(doors_m=options.get("doors"), windows_m=options.get("windows"))
        return drawn(with_openings(found.plan, rules), rules, found.notes)
