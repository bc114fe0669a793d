"""Exploration of a building that nobody knows."""
