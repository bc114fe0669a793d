"""The footprint of a body on the floor: a disc, or a convex polygon."""

from __future__ import annotations

import math
from dataclasses import dataclass

import shapely

from robotteamsim.scenario.base import PlanarPose, wrong
from robotteamsim.scenario.plan import Corners, counter_clockwise

MAX_CORNERS = 8
"""Box2D's limit for polygons."""
MAX_REACH_M = 5.0
MIN_WIDTH_M = 0.02
"""Thinner bodies would need too many physics steps."""

_INSET_M = 1e-3
"""A polygon is shrunk by this distance and then has it as its margin, so that the overlap of bodies is a distance."""


@dataclass(frozen=True, slots=True)
class Body:
    """A body at a pose: all points within `margin_m` of `core`, in the map frame [m]."""

    core: shapely.Geometry
    margin_m: float

    def overlaps(self, other: Body, slack_m: float) -> bool:
        """Whether two bodies overlap by more than the slack [m]."""
        return bool(shapely.distance(self.core, other.core) < self.margin_m + other.margin_m - slack_m)

    def overlaps_shape(self, shape: shapely.Geometry, slack_m: float) -> bool:
        """Whether it overlaps a shape by more than the slack [m]."""
        return bool(shapely.distance(self.core, shape) < self.margin_m - slack_m)


def disc_at(radius_m: float, pose: PlanarPose) -> Body:
    """Return a disc around a pose."""
    return Body(shapely.Point(pose[0], pose[1]), radius_m)


def polygon_at(corners: Corners, pose: PlanarPose) -> Body:
    """Return a polygon whose corners are given in the frame of a pose."""
    outline = shapely.Polygon(corners_at(corners, pose))
    return Body(outline.buffer(-_INSET_M, join_style="mitre"), _INSET_M)


def corners_at(corners: Corners, pose: PlanarPose) -> Corners:
    """Return corners, given in the frame of a pose, in the map frame [m]."""
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    return tuple((pose[0] + cos * x - sin * y, pose[1] + sin * x + cos * y) for x, y in corners)


def check_footprint(key: str, corners: Corners) -> None:
    """Raise a model's error unless corners are a convex body around base_link, clockwise or counter-clockwise."""
    if not 3 <= len(corners) <= MAX_CORNERS:
        raise wrong(key, f"{len(corners)} corners; expected 3 to {MAX_CORNERS}")
    ring = counter_clockwise(corners)
    for i, (x, y) in enumerate(ring):
        (x1, y1), (x2, y2) = ring[(i + 1) % len(ring)], ring[(i + 2) % len(ring)]
        if not (x1 - x) * (y2 - y1) - (y1 - y) * (x2 - x1) > 0.0:
            raise wrong(key, f"is not convex at [{x1:g}, {y1:g}]")
        if not x * y1 - y * x1 > 0.0:
            raise wrong(key, f"base_link, [0, 0], is outside the side from [{x:g}, {y:g}] to [{x1:g}, {y1:g}]")
    reach_m = max(math.hypot(x, y) for x, y in ring)
    if reach_m > MAX_REACH_M:
        raise wrong(key, f"reaches {reach_m:g} m from base_link; expected at most {MAX_REACH_M:g}")
    width_m = shapely.minimum_width(shapely.Polygon(ring)).length
    if width_m < MIN_WIDTH_M:
        raise wrong(key, f"is {width_m:g} m wide; expected at least {MIN_WIDTH_M:g}")
