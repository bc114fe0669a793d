"""Finds, builds and guards the controllers of a team."""
