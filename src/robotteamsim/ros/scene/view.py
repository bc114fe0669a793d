"""The default view of rviz, which just fits the building; texts are laid out for it."""

import itertools
import math

import shapely

from robotteamsim.scenario import Bounds

FITTED_M = 60.0, 40.0
"""Width and depth of the building for which rviz/robotteamsim.rviz was made."""

DISTANCE_M, PITCH_RAD, FOCUS_NORTH_M = 58.0, 1.12, -1.6
"""The camera of that view; it looks north."""

HIGHEST_SHARE = 0.9
"""A solid is drawn as if it reached at most this share of the camera's height."""


def unit(bounds: Bounds) -> float:
    """Return the size of a building relative to that one; sizes in proportion to it are equal on the screen."""
    sides_m = (high - low for low, high in zip(bounds.min, bounds.max, strict=True))
    return max(side_m / fitted_m for side_m, fitted_m in zip(sides_m, FITTED_M, strict=True))


def eye_m(bounds: Bounds) -> tuple[float, float, float]:
    """Return the position of the default view's camera over a building, in the map frame."""
    x, y = ((low + high) / 2.0 for low, high in zip(bounds.min, bounds.max, strict=True))
    scale = unit(bounds)
    south_m = DISTANCE_M * math.cos(PITCH_RAD) - FOCUS_NORTH_M
    return (x, y - scale * south_m, scale * DISTANCE_M * math.sin(PITCH_RAD))


def covered(eye_m: tuple[float, float, float], footprint: shapely.Polygon, height_m: float) -> shapely.Geometry:
    """Return the part of the floor that an upright solid covers, as seen by the default view's camera."""
    x, y, z = eye_m
    grows = z / (z - min(height_m, HIGHEST_SHARE * z))
    top = shapely.affinity.scale(footprint, grows, grows, origin=(x, y))
    low, high = footprint.exterior.coords, top.exterior.coords
    sides = [
        shapely.MultiPoint([*ends, *shifted]).convex_hull
        for ends, shifted in zip(itertools.pairwise(low), itertools.pairwise(high), strict=True)
    ]
    return shapely.union_all([footprint, top, *sides])
