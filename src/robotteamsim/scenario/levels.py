"""The levels of a building, which lie side by side in its plan, and the ways between them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from pydantic import Field, model_validator

from robotteamsim.scenario.base import Many, Model, Name, Point, wrong
from robotteamsim.scenario.shapes import Bounds, check_polygon, shown_point

Portal = tuple[Point, Point, float]
"""Two places in `map`, and the length of the way between them [m]."""

Traveller = Literal["robots", "people"]
"""Who goes over a passage: robots, or people and firefighters on foot."""

MOST_LEVELS = 100
_LEAST_RISE_M = 0.01
"""Levels less far above each other are at the same height."""
_FARTHEST_M = 1e5
"""The sums of propagation are exact where levels are moved above each other by at most twice this."""
_SHIFTED_M = 2.0
"""The stops of a lift are at most so far beside each other."""
_TOP_HEIGHT_M = 3.0
"""Of the highest level, above which nothing is."""

_PLACES_BESIDE = 8
"""Around a stop that is occupied."""

_WALKING_MPS = 1.34
"""Of adults [weidmann1993]: by it people compare lifts with paths on foot."""
_STAIRS_SHARE = 0.77
"""k of stairs with risers of 178 mm and treads of 279 mm over that of floor and ramps, 1.08 / 1.40 [gwynne2016]."""
_PERSONS_PER_M_S = 1.32
"""Most people that pass a metre of effective width of level floor, k / (4 a) = 1.40 / (4 * 0.266) [gwynne2016]."""


class Level(Model):
    """A storey: the part of the plan in which it is drawn, and where that lies in the building."""

    name: Name = Field(description="such as L1")
    bounds: Bounds = Field(description="the part of the plan that it fills; others do not touch it [m]")
    origin: Point = Field(
        default=(0.0, 0.0), description="point of the plan that lies above or below the origins of the others [m]"
    )
    elevation_m: float = Field(ge=-1000.0, le=1000.0, description="height of its floor [m]")
    height_m: float | None = Field(
        default=None,
        ge=0.5,
        le=200.0,
        description="from floor to ceiling; default: to the next floor, or 3 m; rays above it meet no walls [m]",
    )
    floor_material: str | None = Field(
        default=None, description="in materials or radio.materials, for radio; default: radio.floor_loss_db"
    )

    def in_building(self, point: Point) -> tuple[float, float, float]:
        """Return where a point of the plan on this level lies in the building [m]."""
        return point[0] - self.origin[0], point[1] - self.origin[1], self.elevation_m


class Opening(Model):
    """A hole in the floor of the level in which it lies: radio, voices and smoke pass."""

    name: Name = Field(description="a name, unique among the openings")
    polygon: Many[Point] = Field(min_length=3, description="corners in order, not self-crossing [m]")

    @model_validator(mode="after")
    def _check(self) -> Opening:
        check_polygon(self.polygon)
        return self


class Passage(Model):
    """Stairs, a ramp or a lift: who stands at one of its stops can go to another."""

    name: Name = Field(description="a name, unique among the passages")
    kind: Literal["stairs", "ramp", "lift"] = Field(default="lift", description="on stairs and ramps, level by level")
    stops: Many[Point] = Field(
        min_length=2, max_length=MOST_LEVELS, description="one per level, from the lowest up [m]"
    )
    radius_m: float = Field(default=0.5, ge=0.05, le=5.0, description="within which somebody is at a stop [m]")
    length_m: float | None = Field(
        default=None, ge=0.1, le=1000.0, description="of the way between two stops; default: straight in space [m]"
    )
    speed_mps: float = Field(default=0.5, ge=0.01, le=10.0, description="of lifts, and of robots on this way [m/s]")
    wait_s: float = Field(default=0.0, ge=0.0, le=600.0, description="before it, such as for doors of a lift [s]")
    robots: bool | None = Field(default=None, description="whether robots can use it; default: all but stairs")
    people: bool | None = Field(
        default=None, description="whether people and firefighters can use it; default: all but lifts, as in a fire"
    )
    walking_share: float | None = Field(
        default=None,
        ge=0.05,
        le=2.0,
        description="speed of people on stairs and ramps over their walking speed; default: 0.77 on stairs, 1 on ramps "
        "[gwynne2016]",
    )
    width_m: float = Field(
        default=1.0,
        ge=0.1,
        le=100.0,
        description="effective width of stairs and ramps, which limits how many people enter per second [m]",
    )

    def takes(self, by: Traveller) -> bool:
        """Whether robots, or people, can use it."""
        if by == "robots":
            return self.kind != "stairs" if self.robots is None else self.robots
        return self.kind != "lift" if self.people is None else self.people

    @property
    def share(self) -> float:
        """Speed of people on stairs and ramps over their walking speed."""
        if self.walking_share is not None:
            return self.walking_share
        return _STAIRS_SHARE if self.kind == "stairs" else 1.0

    @property
    def headway_s(self) -> float:
        """Least time between two people who enter it on the same level [s]."""
        return 0.0 if self.kind == "lift" else 1.0 / (_PERSONS_PER_M_S * self.share * self.width_m)


@dataclass(frozen=True, slots=True)
class Way:
    """A way from one stop of a passage to another [m]."""

    passage: Passage
    start: Point
    end: Point
    length_m: float

    @property
    def back(self) -> Way:
        """The same way in the other direction."""
        return Way(self.passage, self.end, self.start, self.length_m)

    def time_s(self, walking_mps: float | None = None) -> float:
        """Return how long it takes robots, or somebody on foot who walks at this speed on level floor [s]."""
        on_foot = walking_mps is not None and self.passage.kind != "lift"
        speed_mps = walking_mps * self.passage.share if on_foot and walking_mps else self.passage.speed_mps
        return self.passage.wait_s + self.length_m / speed_mps

    def equivalent_m(self, by: Traveller) -> float:
        """Return the path on level floor that takes robots, or people, as long, for whoever plans [m]."""
        if by == "robots":
            return self.time_s() * self.passage.speed_mps
        return self.time_s(_WALKING_MPS) * _WALKING_MPS


def level_at(levels: Sequence[Level], point: Point) -> Level | None:
    """Return the level on which a point of the plan lies; None beside all."""
    return next((level for level in levels if level.bounds.contains(point)), None)


def point_below(levels: Sequence[Level], level: Level, point: Point) -> tuple[Level, Point] | None:
    """Return the next lower level under a point of the plan on a level, and the point there; None: there is none."""
    x_m, y_m = point[0] - level.origin[0], point[1] - level.origin[1]
    for below in sorted(levels, key=lambda one: one.elevation_m, reverse=True):
        place = x_m + below.origin[0], y_m + below.origin[1]
        if below.elevation_m < level.elevation_m and below.bounds.contains(place):
            return below, place
    return None


def served_levels(levels: Sequence[Level], passages: Sequence[Passage], by: Traveller) -> list[str]:
    """Return the names of the levels to which robots, or people, can go from others, in the plan's order."""
    stops = [stop for passage in passages if passage.takes(by) for stop in passage.stops]
    return [level.name for level in levels if any(level.bounds.contains(stop) for stop in stops)]


def ceiling_height_m(levels: Sequence[Level], level: Level) -> float:
    """Return the height of a level's ceiling above its floor [m]."""
    if level.height_m is not None:
        return level.height_m
    above_m = [other.elevation_m for other in levels if other.elevation_m > level.elevation_m]
    return min(above_m) - level.elevation_m if above_m else _TOP_HEIGHT_M


def ways(levels: Sequence[Level], passages: Sequence[Passage], by: Traveller) -> tuple[Way, ...]:
    """Return all ways upwards for robots or people: of stairs and ramps from stop to stop, of lifts to all above."""
    found = []
    for passage in passages:
        if not passage.takes(by):
            continue
        pairs = (
            itertools.combinations(passage.stops, 2) if passage.kind == "lift" else itertools.pairwise(passage.stops)
        )
        for start, end in pairs:
            found.append(Way(passage=passage, start=start, end=end, length_m=_length_m(levels, passage, start, end)))
    return tuple(found)


def both_ways(levels: Sequence[Level], passages: Sequence[Passage], by: Traveller) -> tuple[Way, ...]:
    """Return all ways up and down for robots or people."""
    return tuple(one for way in ways(levels, passages, by) for one in (way, way.back))


def places_at_end(way: Way, position: Point) -> list[Point]:
    """Return where somebody who left from a position may arrive [m]: as far from the stop, at it, or beside it."""
    (x_m, y_m), radius_m = way.end, way.passage.radius_m
    angles = [math.tau * k / _PLACES_BESIDE for k in range(_PLACES_BESIDE)]
    beside = [(radius_m * math.cos(angle), radius_m * math.sin(angle)) for angle in angles]
    offsets = ((position[0] - way.start[0], position[1] - way.start[1]), (0.0, 0.0), *beside)
    return [(x_m + dx_m, y_m + dy_m) for dx_m, dy_m in offsets]


def portals(levels: Sequence[Level], passages: Sequence[Passage], by: Traveller) -> list[Portal]:
    """Return the ends and the equivalent length of all ways, as a `PlanningGrid` takes them [m]."""
    return [(way.start, way.end, way.equivalent_m(by)) for way in ways(levels, passages, by)]


def _length_m(levels: Sequence[Level], passage: Passage, start: Point, end: Point) -> float:
    if passage.length_m is not None:
        return passage.length_m
    below, above = level_at(levels, start), level_at(levels, end)
    assert below is not None
    assert above is not None
    return math.dist(below.in_building(start), above.in_building(end))


def check_levels(levels: Sequence[Level], openings: Sequence[Opening], passages: Sequence[Passage]) -> None:
    """Raise a plan's error for levels that overlap, and for openings and stops that lie on none."""
    for i, one in enumerate(levels):
        for key, place in (("origin", one.origin), ("bounds", one.bounds.min), ("bounds", one.bounds.max)):
            if max(map(abs, place)) > _FARTHEST_M:
                text = f"{shown_point(place)} is more than {_FARTHEST_M / 1e3:g} km from 0"
                raise wrong(f"levels.{i}.{key}", text)
    for (i, first), (j, second) in itertools.combinations(enumerate(levels), 2):
        if abs(first.elevation_m - second.elevation_m) < _LEAST_RISE_M:
            raise wrong(f"levels.{j}.elevation_m", f"{second.elevation_m:g} is also that of levels.{i}")
        if first.bounds.overlaps(second.bounds):
            raise wrong(f"levels.{j}.bounds", f"{second.bounds} touches levels.{i}, {first.bounds}")
    for key, items in (("openings", openings), ("passages", passages)):
        if items and not levels:
            raise wrong(f"{key}.0", "needs levels")
    for i, opening in enumerate(openings):
        if any(level_at(levels, corner) is not level_at(levels, opening.polygon[0]) for corner in opening.polygon):
            raise wrong(f"openings.{i}.polygon", "lies on more than one level")
        if level_at(levels, opening.polygon[0]) is None:
            raise wrong(f"openings.{i}.polygon", f"{shown_point(opening.polygon[0])} is on no level")
    for i, passage in enumerate(passages):
        floors: list[float] = []
        places: list[Point] = []
        for j, stop in enumerate(passage.stops):
            level = level_at(levels, stop)
            if level is None:
                raise wrong(f"passages.{i}.stops.{j}", f"{shown_point(stop)} is on no level")
            floors.append(level.elevation_m)
            if j > 0 and floors[j] <= floors[j - 1]:
                raise wrong(f"passages.{i}.stops.{j}", "is not on a higher level than the stop before")
            places.append(level.in_building(stop)[:2])
            if passage.kind == "lift" and (beside_m := math.dist(places[0], places[j])) > _SHIFTED_M:
                text = f"is {beside_m:.3g} m beside the lowest stop; expected above it by the origins of the levels"
                raise wrong(f"passages.{i}.stops.{j}", text)
