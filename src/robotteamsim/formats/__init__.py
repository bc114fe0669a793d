"""Files of other programs: importers and exporters by name, ours and those of users' packages."""

from robotteamsim.formats.exporter import Exported, Exporter, PlanExporter, exporters
from robotteamsim.formats.importer import Imported, Importer, importer_of, importers, read_with

__all__ = [
    "Exported",
    "Exporter",
    "Imported",
    "Importer",
    "PlanExporter",
    "exporters",
    "importer_of",
    "importers",
    "read_with",
]
