"""Objects that robots push: boxes and barrels."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from robotteamsim.scenario.base import SMALLEST, Model, Name, PlanarPose, Point, wrong
from robotteamsim.scenario.body import MAX_REACH_M, MIN_WIDTH_M, Body, disc_at, polygon_at
from robotteamsim.scenario.plan import Corners

SizeM = Annotated[float, Field(ge=MIN_WIDTH_M, le=MAX_REACH_M)]


class MovableObject(Model):
    """A box or a barrel: it slides and turns when pushed, until ground friction stops it."""

    name: Name = Field(description="a name, unique among objects")
    kind: Literal["box", "barrel"] = Field(default="box", description="box or barrel")
    size_m: Point | None = Field(default=None, description="length and width of a box [m]")
    radius_m: SizeM | None = Field(default=None, description="of a barrel [m]")
    height_m: float = Field(default=0.5, ge=SMALLEST, le=5.0, description="for 3D views [m]")
    pose: PlanarPose = Field(description="[x, y, yaw] of its centre in the map frame [m, m, rad]")
    mass_kg: float = Field(default=2.0, ge=SMALLEST, le=10_000.0, description="mass [kg]")
    friction: float = Field(default=0.5, ge=SMALLEST, le=10.0, description="of the ground, as a share of the weight")

    @model_validator(mode="after")
    def _check(self) -> MovableObject:
        wanted, other = ("size_m", "radius_m") if self.kind == "box" else ("radius_m", "size_m")
        if getattr(self, wanted) is None:
            raise wrong(wanted, f"missing; expected {type(self).model_fields[wanted].description}")
        if getattr(self, other) is not None:
            raise wrong(other, f"a {self.kind} has {wanted} instead")
        for side_m in self.size_m or ():
            if not MIN_WIDTH_M <= side_m <= MAX_REACH_M:
                raise wrong("size_m", f"{side_m:g} is not within {MIN_WIDTH_M:g} to {MAX_REACH_M:g}")
        return self

    @property
    def corners_m(self) -> Corners:
        """The corners of a box around its centre, counter-clockwise [m]; empty for a barrel."""
        if self.size_m is None:
            return ()
        x, y = 0.5 * self.size_m[0], 0.5 * self.size_m[1]
        return ((-x, -y), (x, -y), (x, y), (-x, y))

    @property
    def reach_m(self) -> float:
        """Radius of the smallest disc around its centre that contains it [m]."""
        return self.radius_m or max(math.hypot(x, y) for x, y in self.corners_m)

    def body_at(self, pose: PlanarPose) -> Body:
        """Return its body at a pose."""
        return disc_at(self.radius_m, pose) if self.radius_m else polygon_at(self.corners_m, pose)
