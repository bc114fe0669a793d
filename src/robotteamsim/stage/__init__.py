"""Importer and exporter of worlds of the Stage simulator [vaughan2008]."""

from robotteamsim.stage.exporting import StageExport, export_world
from robotteamsim.stage.importing import StageImport, import_world

__all__ = ["StageExport", "StageImport", "export_world", "import_world"]
