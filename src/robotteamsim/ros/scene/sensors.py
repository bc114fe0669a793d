"""Sonars and GPS in the 3D scene."""

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from geometry_msgs.msg import Point
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker

from robotteamsim.geometry import Pose
from robotteamsim.ros.scene.plan import AREA_Z_M
from robotteamsim.ros.scene.shapes import (
    DISC_LAYER,
    Colour,
    Mesh,
    Position,
    drawn_below,
    faded,
    lines,
    marker,
    shaded,
)
from robotteamsim.ros.scene.team import robot_colour

CONE_STEP_RAD = 0.1
RETURN_WIDTH_M = 0.05
PIN_HEIGHT_M = 0.8
PIN_M = 0.22
DOT_M = 0.09
MIN_DISC_M = 0.15


@dataclass(frozen=True, slots=True)
class SonarView:
    """The range of one sonar, and its pose in the map frame; its x axis is the axis of the cone."""

    sonar: Pose
    height_m: float
    opening_rad: float
    range_max_m: float
    range_m: float

    @property
    def returned(self) -> bool:
        """Whether there is a return."""
        return self.range_m < self.range_max_m


@dataclass(frozen=True, slots=True)
class FixView:
    """A fix of a GPS receiver in the map frame, with its standard deviation [m]."""

    place_m: tuple[float, float]
    sigma_m: float


def sonar_markers(views: Mapping[int, Sequence[SonarView]]) -> list[Marker]:
    """Return the cones of each robot's sonars, by id: up to the return, which is an arc; faint without a return."""
    result = []
    for robot_id, sonars in views.items():
        tint = robot_colour(robot_id)
        cones, arcs = Mesh(), []
        for view in sonars:
            start = (view.sonar.x_m, view.sonar.y_m, view.height_m)
            rim = _rim(view)
            near, far = (0.7, 0.3) if view.returned else (0.2, 0.0)
            for left, right in itertools.pairwise(rim):
                cones.triangle((start, left, right), [faded(tint, near), faded(tint, far), faded(tint, far)])
            if view.returned:
                arcs += [(left, right, tint) for left, right in itertools.pairwise(rim)]
        if len(cones):
            result.append(cones.marker("sonars", robot_id))
        if arcs:
            result.append(lines("sonar_returns", robot_id, arcs, RETURN_WIDTH_M))
    return result


def _rim(view: SonarView) -> list[Position]:
    count = max(2, math.ceil(view.opening_rad / CONE_STEP_RAD))
    low_rad = view.sonar.yaw_rad - 0.5 * view.opening_rad
    angles_rad = [low_rad + view.opening_rad * i / count for i in range(count + 1)]
    x_m, y_m, reach_m = view.sonar.x_m, view.sonar.y_m, min(max(view.range_m, 0.0), view.range_max_m)
    return [(x_m + reach_m * math.cos(a), y_m + reach_m * math.sin(a), view.height_m) for a in angles_rad]


def fix_markers(views: Mapping[int, Sequence[FixView]]) -> list[Marker]:
    """Return a pin at each robot's newest fix, by its id, with a disc of one standard deviation; dots at older ones."""
    result = []
    for robot_id, fixes in views.items():
        if not fixes:
            continue
        tint = robot_colour(robot_id)
        (x_m, y_m), sigma_m = fixes[-1].place_m, fixes[-1].sigma_m
        disc = Mesh()
        disc.ring((x_m, y_m), 0.0, max(sigma_m, MIN_DISC_M), AREA_Z_M, faded(tint, 0.22))
        result.append(drawn_below(disc.marker("fix_discs", robot_id), DISC_LAYER))
        stalk: tuple[Position, Position, Colour] = ((x_m, y_m, 0.0), (x_m, y_m, PIN_HEIGHT_M), shaded(tint, 0.8))
        result.append(lines("fix_stalks", robot_id, [stalk], 0.05))
        head = (x_m, y_m, PIN_HEIGHT_M)
        result.append(marker("fixes", robot_id, Marker.SPHERE, tint, position=head, scale=(PIN_M,) * 3))
        if len(fixes) > 1:
            result.append(_dots(robot_id, fixes[:-1], tint))
    return result


def _dots(robot_id: int, fixes: Sequence[FixView], tint: Colour) -> Marker:
    """Return older fixes, which fade with age."""
    dots = marker("old_fixes", robot_id, Marker.SPHERE_LIST, faded(tint, 0.99), scale=(DOT_M,) * 3)
    for i, fix in enumerate(fixes):
        dots.points.append(Point(*fix.place_m, AREA_Z_M))
        dots.colors.append(ColorRGBA(*faded(tint, 0.2 + 0.7 * i / len(fixes))))
    return dots
