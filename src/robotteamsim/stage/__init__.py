"""Importer of worlds of the Stage simulator [vaughan2008]."""

from robotteamsim.stage.importing import StageImport, import_world

__all__ = ["StageImport", "import_world"]
