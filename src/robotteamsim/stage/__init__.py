"""Importer and exporter of worlds of the Stage simulator [vaughan2008]."""

from robotteamsim.stage.exporting import export_world
from robotteamsim.stage.importing import import_world

__all__ = ["export_world", "import_world"]
