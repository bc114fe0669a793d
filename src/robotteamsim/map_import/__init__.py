"""Converts the image of a building to straight walls and polygons: cells, outlines, pieces."""
