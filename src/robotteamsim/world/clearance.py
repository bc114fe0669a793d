"""Whether points, robots and objects are inside the plan and clear of its solids."""

import numpy as np
import shapely

from robotteamsim.errors import PlacementError
from robotteamsim.scenario.base import PlanarPose
from robotteamsim.scenario.body import Body
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.plan import Solid, footprints, solids
from robotteamsim.scenario.sections import Robot

TOUCH_M = 1e-6
"""Bodies may be placed touching each other, up to rounding."""


class Solids:
    """The solids of a plan at the start, with or without doors, for checks whether a place is free."""

    def __init__(self, plan: FloorPlan, doors: bool = True) -> None:
        self._solids = [solid for solid in solids(plan) if doors or solid.kind != "door"]
        self._shapes = footprints(self._solids)

    def at_point(self, point: tuple[float, float]) -> Solid | None:
        """Return the first solid that contains a point; None if the point is free."""
        return self._first(shapely.distance(self._shapes, shapely.Point(point)) == 0.0)

    def on_line(self, start: tuple[float, float], end: tuple[float, float]) -> Solid | None:
        """Return the first solid that the straight line between two points touches; None if the line is free."""
        line = shapely.Point(start) if start == end else shapely.LineString([start, end])
        return self._first(shapely.intersects(self._shapes, line))

    def under_robot(self, robot: Robot, pose: PlanarPose) -> Solid | None:
        """Return the first solid that a robot overlaps; None if it overlaps none."""
        if not robot.footprint_m:
            return self._first(shapely.distance(self._shapes, shapely.Point(pose[:2])) < robot.radius_m)
        return self.under_body(robot.body_at(pose), 0.0)

    def under_body(self, body: Body, slack_m: float) -> Solid | None:
        """Return the first solid that a body overlaps by more than the slack [m]; None if it overlaps none."""
        shapes = zip(self._solids, self._shapes, strict=True)
        return next((solid for solid, shape in shapes if body.overlaps_shape(shape, slack_m)), None)

    def _first(self, hits: np.ndarray) -> Solid | None:
        found = np.flatnonzero(hits)
        return self._solids[found[0]] if len(found) else None


def check_inside(plan: FloorPlan, key: str, point: tuple[float, float]) -> None:
    """Raise PlacementError, with its key, for a point outside the plan."""
    if not plan.bounds.contains(point):
        raise PlacementError(f"{key}: {point_text(point)} lies outside the plan, {plan.bounds}", key)


def overlaps(solid: Solid) -> str:
    """Return the text of messages about a body in a solid."""
    return f"overlaps {solid.kind} '{solid.name}'"


def point_text(point: tuple[float, ...]) -> str:
    """Return a point as text for messages."""
    return f"[{', '.join(f'{value:g}' for value in point)}]"
