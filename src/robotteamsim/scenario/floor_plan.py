"""The floor plan: what a building is, as vectors. Everything else (grids, bodies, faces, 3D walls) is made from it."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from robotteamsim.scenario.base import Model, Point, tuple_of


class Bounds(Model):
    """The rectangle that the plan fills; beyond it nothing exists."""

    min: Point = Field(default=(0.0, 0.0), description="lower left corner [m]")
    max: Point = Field(description="upper right corner [m]")


class Wall(Model):
    """A straight wall of rectangular footprint around its centre line; its ends are cut square at `from` and `to`."""

    name: str = Field(description="unique among the plan's elements")
    start: Point = Field(alias="from", description="one end of the centre line [m]")
    end: Point = Field(alias="to", description="other end of the centre line [m]")
    thickness_m: float = Field(default=0.2, gt=0.0, le=0.8, description="decides the loss class (Table 3) [m]")
    height_m: float = Field(default=2.6, gt=0.0, le=20.0, description="for 3D views [m]")
    material: str | None = Field(default=None, description="key into radio.materials; none: by thickness")


class Block(Model):
    """A solid polygon: a stair core, a pillar."""

    name: str = Field(description="unique among the plan's elements")
    kind: Literal["block", "pillar"] = Field(default="block", description="a plan may switch pillars off for radio")
    polygon: tuple_of(Point) = Field(min_length=3, description="corners in order, not self-crossing [m]")  # type: ignore[valid-type]
    height_m: float = Field(default=2.6, gt=0.0, le=20.0, description="for 3D views [m]")
    material: str | None = Field(default=None, description="key into radio.materials; none: by the smaller width")


class Door(Model):
    """A door leaf: one segment across a gap between walls."""

    name: str = Field(description="unique among the plan's elements")
    start: Point = Field(alias="from", description="hinge side of the leaf [m]")
    end: Point = Field(alias="to", description="other side of the leaf [m]")
    kind: Literal["normal", "fireproof"] = Field(default="normal", description="Table 3: 1.4 dB or 10.2 dB when closed")
    closed: bool = Field(default=False, description="state at the start")
    thickness_m: float = Field(default=0.06, gt=0.0, le=0.2, description="of the leaf as a body [m]")
    height_m: float = Field(default=2.1, gt=0.0, le=20.0, description="for 3D views [m]")


class FloorPlan(Model):
    """One floor of a building."""

    name: str = Field(description="shown in tables and pictures")
    bounds: Bounds
    walls: tuple_of(Wall) = Field(default=(), description="straight walls")  # type: ignore[valid-type]
    blocks: tuple_of(Block) = Field(default=(), description="solid polygons and pillars")  # type: ignore[valid-type]
    doors: tuple_of(Door) = Field(default=(), description="door leaves in gaps between walls")  # type: ignore[valid-type]
