"""Exporter of scenarios to worlds of the Gazebo simulator, in SDF."""

from robotteamsim.gazebo.exporting import export_world

__all__ = ["export_world"]
