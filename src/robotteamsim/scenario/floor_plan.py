"""The floor plan of a building, as vectors. Everything else (grids, bodies, faces, 3D walls) is derived from it."""

from __future__ import annotations

import math
from typing import Literal

import shapely
from pydantic import Field, model_validator

from robotteamsim.scenario.base import SMALLEST, Many, Model, Name, Point, by_index, check_names, wrong
from robotteamsim.scenario.materials import Material

MIN_SIDE_M = 0.01
MAX_SIDE_M = 1000.0
"""Grids of larger plans would not fit into memory."""

MAX_COORDINATE_M = 999_000.0
"""The exact sums of propagation are valid up to 1000 km; walls and cells extend a little beyond the bounds."""

MIN_AREA_M2 = 1e-6
"""Smallest area of a block: a square millimetre."""

MIN_SWING_RAD = 0.1
"""A leaf that swings by less than this would not open the gap."""


class Bounds(Model):
    """The rectangle that the plan fills; nothing exists outside it."""

    min: Point = Field(default=(0.0, 0.0), description="lower left corner [m]")
    max: Point = Field(description="upper right corner [m]")

    @model_validator(mode="after")
    def _check(self) -> Bounds:
        for axis, (low, high) in zip("xy", zip(self.min, self.max, strict=True), strict=True):
            if not high > low:
                raise wrong("max", f"{axis} {high:g} is not above min, {low:g}")
            if high - low < MIN_SIDE_M:
                raise wrong("max", f"{axis} {high:g} is less than {MIN_SIDE_M:g} m from min, {low:g}")
            if high - low > MAX_SIDE_M:
                raise wrong("max", f"{axis} {high:g} is more than {MAX_SIDE_M:g} m from min, {low:g}")
            for key, value in (("min", low), ("max", high)):
                if abs(value) > MAX_COORDINATE_M:
                    raise wrong(key, f"{axis} {value:g} is more than {MAX_COORDINATE_M / 1000:g} km from 0")
        return self

    def contains(self, point: Point) -> bool:
        """Whether a point lies inside or on the border."""
        return all(low <= value <= high for low, value, high in zip(self.min, point, self.max, strict=True))

    def __str__(self) -> str:
        return f"[{self.min[0]:g}, {self.min[1]:g}] .. [{self.max[0]:g}, {self.max[1]:g}]"


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
        _check_segment(self.start, self.end)
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
        outline = shapely.Polygon(self.polygon)
        if outline.convex_hull.area < MIN_AREA_M2:  # the signed area of an outline that crosses itself may be 0
            raise wrong("polygon", f"encloses no area: its corners lie on a line through {_place(*self.polygon[0])}")
        if not outline.is_valid:
            raise wrong("polygon", f"crosses or touches itself at {_where_invalid(outline)}")
        if outline.area < MIN_AREA_M2:
            raise wrong("polygon", f"encloses no area at {_place(*self.polygon[0])}")
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
        _check_segment(self.start, self.end)
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
        _check_segment(self.start, self.end)
        return self


class FloorPlan(Model):
    """One floor of a building."""

    name: Name = Field(description="shown in tables and pictures")
    bounds: Bounds = Field(description="the rectangle [m] that the plan fills")
    walls: Many[Wall] = Field(default=(), description="straight walls")
    blocks: Many[Block] = Field(default=(), description="solid polygons and pillars")
    doors: Many[Door] = Field(default=(), description="door leaves in gaps between walls")
    bays: Many[BayRow] = Field(default=(), description="rows of parking bays, for pictures and 3D views")
    materials: Many[Material] = Field(default=(), description="what walls and blocks can be built of")
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
        check_names(by_index("materials", self.materials))
        for place, element in elements.items():
            points = element.polygon if isinstance(element, Block) else (element.start, element.end)
            for point in points:
                if not self.bounds.contains(point):
                    raise wrong(place, f"{_place(*point)} lies outside the bounds {self.bounds}")
        return self


def _where_invalid(outline: shapely.Polygon) -> str:
    """Return the point at the end of what GEOS says: "Self-intersection[2 6.5]" gives "[2, 6.5]"."""
    x, y = shapely.is_valid_reason(outline).rpartition("[")[2].rstrip("]").split()
    return _place(float(x), float(y))


def _place(x: float, y: float) -> str:
    return f"[{x:g}, {y:g}]"


def _check_segment(start: Point, end: Point) -> None:
    if start == end:
        raise wrong("to", f"{_place(*end)} is also the point of 'from'")
