"""Exporter of scenarios to worlds of the Gazebo simulator, in SDF."""

from robotteamsim.gazebo.exporting import GazeboExport, export_world

__all__ = ["GazeboExport", "export_world"]
