"""Finds, creates and guards the controllers of a team."""
