"""Converter between scenarios and worlds of the Gazebo simulator, in SDF."""

from robotteamsim.gazebo.exporting import GazeboExport, export_world
from robotteamsim.gazebo.importing import GazeboImport, import_world

__all__ = ["GazeboExport", "GazeboImport", "export_world", "import_world"]
