"""Victims: where they are, how they walk, whether they call."""

from __future__ import annotations

import itertools
import math

import numpy as np
import shapely
from pydantic import Field, model_validator

from robotteamsim.scenario.base import Many, Model, Name, Point, wrong

SMALLEST_ROOM_M2 = 0.01
"""Walks between places in a smaller region would be too short to compute in reasonable time."""
SHORTEST_LOOP_M = 0.1


class Region(Model):
    """A part of the floor in which people are, or walk to random places: a disc, or the polygon of a room."""

    center: Point | None = Field(default=None, description="[x, y] of the disc in the map frame [m]")
    radius_m: float | None = Field(default=None, ge=0.1, le=1000.0, description="of the disc [m]")
    polygon: Many[Point] | None = Field(default=None, min_length=3, description="corners in order [m]")

    @model_validator(mode="after")
    def _check(self) -> Region:
        if self.polygon is None:
            for key in ("center", "radius_m"):
                if getattr(self, key) is None:
                    raise wrong(key, "missing; expected center and radius_m, or polygon")
            return self
        for key in ("center", "radius_m"):
            if getattr(self, key) is not None:
                raise wrong(key, "not allowed together with polygon")
        shape = shapely.Polygon(self.polygon)
        if not shape.is_valid or shape.area < SMALLEST_ROOM_M2:
            raise wrong("polygon", f"crosses itself, or is smaller than {SMALLEST_ROOM_M2:g} m2")
        return self

    def contains(self, point: Point) -> bool:
        """Whether a point lies inside or on the border."""
        return bool(self.contain(np.array([point]))[0])

    def contain(self, points: np.ndarray) -> np.ndarray:
        """Return whether points lie inside or on the border, bool, shape (n,). Args: shape (n, 2), in `map` [m]."""
        inside: np.ndarray
        if self.polygon is not None:
            inside = shapely.intersects_xy(shapely.Polygon(self.polygon), *points.T)
            return inside
        assert self.center is not None
        assert self.radius_m is not None
        inside = np.hypot(*(points - self.center).T) <= self.radius_m
        return inside

    def box(self) -> tuple[Point, Point]:
        """Return the lower left and the upper right corner of the smallest box that contains the region [m]."""
        if self.polygon is not None:
            xs, ys = zip(*self.polygon, strict=True)
            return (min(xs), min(ys)), (max(xs), max(ys))
        assert self.center is not None
        assert self.radius_m is not None
        (x, y), radius_m = self.center, self.radius_m
        return (x - radius_m, y - radius_m), (x + radius_m, y + radius_m)


class Victim(Model):
    """A victim, who may walk and may call for help."""

    name: Name = Field(description="a name, unique among victims")
    position: Point = Field(description="[x, y] in the map frame, at the start [m]")
    path: Many[Point] = Field(default=(), max_length=1000, description="places to walk to, in this order [m]")
    loop: bool = Field(default=False, description="after the last place of path, walk to its first one again")
    wander: Region | None = Field(default=None, description="region with random places to walk to")
    speed_mps: float = Field(default=0.5, ge=0.001, le=10.0, description="walking speed [m/s]")
    flees: bool = Field(default=False, description="walks to the nearest exit that can be reached")
    flees_after_s: float = Field(default=0.0, ge=0.0, le=1e6, description="until then, this person stays [s]")
    can_walk: bool = Field(default=False, description="follows a firefighter, who otherwise carries this person")
    calling: bool = Field(default=True, description="calls for help; a silent victim is only found by coming near")

    @model_validator(mode="after")
    def _check(self) -> Victim:
        if self.path and self.wander is not None:
            raise wrong("wander", "not allowed together with path")
        if self.flees and self.walks:
            raise wrong("flees", "not allowed together with path or wander")
        if self.loop:
            if not self.path:
                raise wrong("loop", "only allowed with path")
            around = (*self.path, self.path[0])
            if sum(itertools.starmap(math.dist, itertools.pairwise(around))) < SHORTEST_LOOP_M:
                raise wrong("loop", f"is shorter than {SHORTEST_LOOP_M:g} m; expected places farther apart")
        return self

    @property
    def walks(self) -> bool:
        """Whether this victim moves by themselves."""
        return bool(self.path) or self.wander is not None

    def legs(self) -> list[tuple[str, Point, Point]]:
        """Return the straight lines of the path, each with the key of its end."""
        places = [self.position, *self.path]
        legs = [(f"path.{i}", a, b) for i, (a, b) in enumerate(itertools.pairwise(places))]
        return [*legs, ("loop", self.path[-1], self.path[0])] if self.loop else legs
