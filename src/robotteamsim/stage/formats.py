"""The importer and exporter of worlds of Stage."""

from pathlib import Path
from typing import Any, ClassVar

from robotteamsim.formats import Exported, Imported, Importer, PlanExporter
from robotteamsim.formats.options import Options
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.setup import Setup
from robotteamsim.stage.exporting import export_world
from robotteamsim.stage.importing import import_world


class StageImporter(Importer):
    """Imports a world as a scenario, see `import_world`."""

    noun = "a world of Stage"
    suffixes = (".world",)
    # Of Stage 4.3.
    sign = r'^\s*(define\s+[\w.-]+\s+[\w.-]+\s*\(|include\s+"|(model|position|window|floorplan)\s*\()'
    makes_scenarios = True
    options: ClassVar[Options] = {
        "--grey": {
            "choices": ("as-import", "as-stage"),
            "help": "what is solid in bitmaps of Stage: as in images, or as in Stage, where the first channel is below "
            "128; default as-import",
        }
    }
    examples = """\
  robotteamsim plan import office.world                      office/office.yaml, office/plan.yaml
  robotteamsim plan import office.world --out DIR && robotteamsim run DIR/office.yaml"""

    def read(self, path: Path, **options: Any) -> Imported:
        """See `Importer.read`."""
        return import_world(path, grey_as_stage=options.get("grey") == "as-stage")


class StageExporter(PlanExporter):
    """Exports a scenario or a floor plan, see `export_world`."""

    help = "write a scenario as a Stage world"
    suffix = "world"
    description = """\
Write a scenario, or a floor plan, as a Stage world, for stage_ros: the same controllers then
drive the same robots in Stage. `plan import` converts it back to an equal scenario."""
    examples = """\
  robotteamsim plan export-stage garage_sar --out DIR        DIR/garage_sar.world
  robotteamsim plan export-stage DIR/plan.yaml --out DIR     the walls, blocks and doors alone"""

    def export(self, setup: Setup, **options: Any) -> Exported:
        """See `Exporter.export`."""
        return export_world(setup.plan, setup.scenario, setup.robots[: setup.scenario.num_robots])

    def export_plan(self, plan: FloorPlan, **options: Any) -> Exported:
        """See `PlanExporter.export_plan`."""
        return export_world(plan)
