"""Markers that show a mission in rviz."""
