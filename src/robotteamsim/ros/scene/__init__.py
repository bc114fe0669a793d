"""What rviz shows of a mission, as markers."""
