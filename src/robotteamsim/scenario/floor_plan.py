"""The floor plan of a building, as vectors. Everything else (grids, bodies, faces, 3D walls) is derived from it."""

from __future__ import annotations

import math
from typing import Literal

from pydantic import Field, model_validator

from robotteamsim.scenario.base import SMALLEST, Many, Model, Name, Point, by_index, check_names, wrong
from robotteamsim.scenario.levels import MOST_LEVELS, Level, Opening, Passage, check_levels, level_at
from robotteamsim.scenario.materials import Material
from robotteamsim.scenario.shapes import MAX_SIDE_M, check_polygon, check_segment, shown_point
from robotteamsim.scenario.shapes import Bounds as Bounds

MIN_SWING_RAD = 0.1
"""A leaf that swings by less than this would not open the gap."""


class Wall(Model):
    """A straight wall with a rectangular footprint around its centre line from `from` to `to`."""

    name: Name = Field(description="a name, unique among the plan's elements")
    start: Point = Field(
        validation_alias="from", serialization_alias="from", description="one end of the centre line [m]"
    )
    end: Point = Field(validation_alias="to", serialization_alias="to", description="other end of the centre line [m]")
    thickness_m: float = Field(default=0.2, ge=SMALLEST, le=0.8, description="determines the loss class (Table 3) [m]")
    height_m: float = Field(default=2.6, ge=SMALLEST, le=20.0, description="for 3D views [m]")
    material: str | None = Field(default=None, description="in materials or radio.materials; default: by thickness")

    @model_validator(mode="after")
    def _check(self) -> Wall:
        check_segment(self.start, self.end)
        return self


class Block(Model):
    """A solid polygon: a stair core, a pillar."""

    name: Name = Field(description="a name, unique among the plan's elements")
    kind: Literal["block", "pillar"] = Field(
        default="block", description="radio.pillars may exclude pillars from the radio model"
    )
    polygon: Many[Point] = Field(min_length=3, description="corners in order, not self-crossing [m]")
    thickness_m: float | None = Field(
        default=None,
        ge=SMALLEST,
        le=MAX_SIDE_M,
        description="determines the loss class (Table 3); default: the least width [m]",
    )
    height_m: float = Field(default=2.6, ge=SMALLEST, le=20.0, description="for 3D views [m]")
    material: str | None = Field(
        default=None, description="in materials or radio.materials; default: by the least width"
    )

    @model_validator(mode="after")
    def _check(self) -> Block:
        check_polygon(self.polygon)
        return self


class Door(Model):
    """A door leaf: one segment across a gap between walls; `door_places` checks the gap."""

    name: Name = Field(description="a name, unique among the plan's elements")
    start: Point = Field(
        validation_alias="from",
        serialization_alias="from",
        description="hinge side of the leaf; a sliding leaf moves beyond it [m]",
    )
    end: Point = Field(validation_alias="to", serialization_alias="to", description="other side of the leaf [m]")
    kind: Literal["normal", "fireproof"] = Field(default="normal", description="Table 3: 1.4 dB or 10.2 dB when closed")
    closed: bool = Field(default=False, description="state at the start")
    fire_resistance_min: float | None = Field(
        default=None,
        ge=1.0,
        le=360.0,
        description="when closed, 30 for a door of class EI 30 [en13501_2]; default: heat.door_endures_s of the fire, "
        "or for ever if fireproof [min]",
    )
    thickness_m: float = Field(default=0.06, ge=SMALLEST, le=0.2, description="of the leaf as a body [m]")
    height_m: float = Field(default=2.1, ge=SMALLEST, le=20.0, description="for 3D views [m]")
    motion: Literal["instant", "swing", "slide"] = Field(
        default="instant",
        description="instant: opens or closes instantly, an open leaf does not exist; swing or slide: the leaf moves",
    )
    time_s: float | None = Field(
        default=None, ge=0.1, le=600.0, description="duration of a swing or slide from closed to open; default 2 s [s]"
    )
    angle_rad: float | None = Field(
        default=None,
        ge=-math.pi,
        le=math.pi,
        description="of a swing: angle of the open leaf about `from`, counter-clockwise; default pi / 2 [rad]",
    )

    @model_validator(mode="after")
    def _check(self) -> Door:
        check_segment(self.start, self.end)
        if self.motion == "instant" and self.time_s is not None:
            raise wrong("time_s", "not allowed for a door whose motion is instant")
        if self.motion != "swing" and self.angle_rad is not None:
            raise wrong("angle_rad", f"not allowed for a door whose motion is {self.motion}")
        if self.angle_rad is not None and abs(self.angle_rad) < MIN_SWING_RAD:
            raise wrong("angle_rad", f"{self.angle_rad:g} is less than {MIN_SWING_RAD:g} to either side")
        return self

    @property
    def leaf_time_s(self) -> float:
        """Time that the leaf takes from closed to open [s]; 0 for an instant door."""
        return 0.0 if self.motion == "instant" else self.time_s or 2.0

    @property
    def leaf_angle_rad(self) -> float:
        """Turn of an open leaf about the hinge, counter-clockwise [rad]."""
        return (self.angle_rad or 0.5 * math.pi) if self.motion == "swing" else 0.0

    @property
    def leaf_shift_m(self) -> Point:
        """Shift of an open leaf [m]."""
        if self.motion != "slide":
            return 0.0, 0.0
        return self.start[0] - self.end[0], self.start[1] - self.end[1]


class BayRow(Model):
    """A row of parking bays painted on the floor: drawn only, not an obstacle."""

    start: Point = Field(
        validation_alias="from", serialization_alias="from", description="one end of the row's open side [m]"
    )
    end: Point = Field(
        validation_alias="to",
        serialization_alias="to",
        description="other end; the bays lie to the left of from -> to [m]",
    )
    depth_m: float = Field(default=5.0, ge=SMALLEST, le=30.0, description="length of a bay [m]")
    count: int = Field(ge=1, le=1000, description="number of bays")

    @model_validator(mode="after")
    def _check(self) -> BayRow:
        check_segment(self.start, self.end)
        return self


class FloorPlan(Model):
    """The floor of a building; levels lie side by side, see `scenario.levels`."""

    name: Name = Field(description="shown in tables and pictures")
    bounds: Bounds = Field(description="the rectangle [m] that the plan fills")
    walls: Many[Wall] = Field(default=(), description="straight walls")
    blocks: Many[Block] = Field(default=(), description="solid polygons and pillars")
    doors: Many[Door] = Field(default=(), description="door leaves in gaps between walls")
    bays: Many[BayRow] = Field(default=(), description="rows of parking bays, for pictures and 3D views")
    materials: Many[Material] = Field(default=(), description="what walls and blocks can be built of")
    levels: Many[Level] = Field(default=(), max_length=MOST_LEVELS, description="storeys; none: everything is on one")
    openings: Many[Opening] = Field(default=(), description="holes in the floors of levels")
    passages: Many[Passage] = Field(default=(), description="stairs, ramps and lifts between levels")
    drawing_offset_m: Point | None = Field(
        default=None, description="coordinates in the drawing that the plan was imported from, of [0, 0] [m]"
    )

    @model_validator(mode="after")
    def _check(self) -> FloorPlan:
        elements: dict[str, Wall | Block | Door] = {
            **by_index("walls", self.walls),
            **by_index("blocks", self.blocks),
            **by_index("doors", self.doors),
        }
        check_names(elements, "element")
        for key in ("materials", "levels", "openings", "passages"):
            check_names(by_index(key, getattr(self, key)))
        check_levels(self.levels, self.openings, self.passages)
        for place, level in by_index("levels", self.levels).items():
            if not (self.bounds.contains(level.bounds.min) and self.bounds.contains(level.bounds.max)):
                raise wrong(f"{place}.bounds", f"{level.bounds} lies outside the bounds of the plan, {self.bounds}")
        for place, element in elements.items():
            points = element.polygon if isinstance(element, Block) else (element.start, element.end)
            for point in points:
                if not self.bounds.contains(point):
                    raise wrong(place, f"{shown_point(point)} lies outside the bounds {self.bounds}")
            on = [level_at(self.levels, point) for point in points] if self.levels else []
            if on and (on[0] is None or any(level is not on[0] for level in on)):
                raise wrong(place, f"{shown_point(points[0])} to {shown_point(points[-1])} is not on one level")
        return self
