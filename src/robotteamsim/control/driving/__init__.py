"""Localisation, the known map, and driving to a goal."""
