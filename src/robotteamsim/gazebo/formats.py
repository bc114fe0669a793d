"""The exporter of worlds of Gazebo."""

from typing import Any, ClassVar

from robotteamsim.formats import Exported, Exporter
from robotteamsim.formats.options import Options
from robotteamsim.gazebo.exporting import export_world
from robotteamsim.setup import Setup


class GazeboExporter(Exporter):
    """Exports a scenario as a world of Gazebo 11, see `export_world`."""

    help = "write a scenario as a Gazebo world"
    suffix = "world"
    description = """\
Write a scenario as a world of Gazebo 11 (SDF): floor, walls, doors with joints, objects, and
robots with their laser and the plugin that drives them. docs/gazebo.md describes the models."""
    examples = """\
  robotteamsim plan export-gazebo garage_sar --out DIR       DIR/garage_sar.world
  gazebo --verbose DIR/garage_sar.world"""
    options: ClassVar[Options] = {
        "--drive": {
            "choices": ("velocity", "wheels"),
            "help": "how robots with a differential drive move; default velocity",
        }
    }

    def export(self, setup: Setup, **options: Any) -> Exported:
        """See `Exporter.export`."""
        return export_world(setup, **options)
