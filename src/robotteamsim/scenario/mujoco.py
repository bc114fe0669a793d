"""Keys that only the world of MuJoCo uses."""

from __future__ import annotations

import math

from pydantic import Field, model_validator

from robotteamsim.scenario.base import SMALLEST, Many, Model, Name, Point, by_index, check_names, wrong
from robotteamsim.scenario.plan import Corners


class Wheels(Model):
    """The wheels of a robot's drive; they touch only the floor."""

    radius_m: float | None = Field(
        default=None,
        gt=0.005,
        le=2.0,
        description="default: a quarter of the body's half width, at most 0.4 height_m [m]",
    )
    friction: float = Field(
        default=0.9, ge=SMALLEST, le=10.0, description="of a tyre on the floor, as a share of its load"
    )


class Gripper(Model):
    """A gripper, which holds one object at a time."""

    reach_m: float = Field(
        default=0.3, ge=SMALLEST, le=10.0, description="from the robot's outline to the object's [m]"
    )
    lift_m: float = Field(default=0.05, ge=0.0, le=2.0, description="height to which it lifts an object [m]")
    max_mass_kg: float = Field(default=5.0, ge=SMALLEST, le=10_000.0, description="of an object that it can lift [kg]")


class Light(Model):
    """A small lamp that shines equally in all directions, for light sensors and cameras."""

    name: Name = Field(description="a name, unique among lights")
    position: Point = Field(description="[x, y] in the map frame [m]")
    height_m: float = Field(default=2.4, ge=SMALLEST, le=100.0, description="above the floor [m]")
    intensity_cd: float = Field(default=120.0, ge=SMALLEST, le=1e6, description="1500 lumen are about 120 cd [cd]")
    lit: bool = Field(default=True, description="whether it is lit at the start")


class Ramp(Model):
    """A slope, or a platform, on the floor; its top is a plane from one end to the other."""

    start: Point = Field(
        validation_alias="from", serialization_alias="from", description="middle of the end with from_height_m [m]"
    )
    end: Point = Field(validation_alias="to", serialization_alias="to", description="middle of the other end [m]")
    width_m: float = Field(default=1.0, ge=0.1, le=100.0, description="across the line from `from` to `to` [m]")
    height_m: float = Field(ge=0.001, le=5.0, description="of its top at `to` [m]")
    from_height_m: float = Field(
        default=0.0, ge=0.0, le=5.0, description="of its top at `from`; a platform has the same as at `to` [m]"
    )

    @model_validator(mode="after")
    def _check(self) -> Ramp:
        if self.length_m < 0.1:
            raise wrong("to", f"is {self.length_m:g} m from 'from'; expected at least 0.1")
        return self

    @property
    def length_m(self) -> float:
        """The distance on the floor from one end to the other [m]."""
        return math.dist(self.start, self.end)

    @property
    def corners(self) -> Corners:
        """Its corners on the floor, counter-clockwise from the right one of `from` [m]."""
        (x0, y0), (x1, y1) = self.start, self.end
        half = 0.5 * self.width_m / self.length_m
        dx, dy = half * (y1 - y0), half * (x0 - x1)
        return (x0 + dx, y0 + dy), (x1 + dx, y1 + dy), (x1 - dx, y1 - dy), (x0 - dx, y0 - dy)

    def top_m(self, point: Point) -> float:
        """Return the height of its top at a place that it covers [m]."""
        (x0, y0), (x1, y1), (x, y) = self.start, self.end, point
        share = ((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / self.length_m**2
        return self.from_height_m + share * (self.height_m - self.from_height_m)


class Mujoco(Model):
    """The physics of `world: mujoco`."""

    timestep_s: float = Field(
        default=0.005, ge=0.0005, le=0.01, description="longest step of the physics; a part of a physics substep [s]"
    )
    body_friction: float = Field(
        default=0.1,
        ge=0.0,
        le=10.0,
        description="of the robots' bodies on walls, doors, objects and other robots, as a share of the force",
    )
    tipped_rad: float = Field(
        default=1.0, gt=0.1, lt=3.1, description="a robot that leans by more than this has tipped over [rad]"
    )
    ramps: Many[Ramp] = Field(default=(), max_length=100, description="slopes and platforms that robots drive on")
    lights: Many[Light] = Field(default=(), max_length=100, description="lamps for light sensors and cameras")

    @model_validator(mode="after")
    def _check(self) -> Mujoco:
        check_names(by_index("lights", self.lights))
        return self
