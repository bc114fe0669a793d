"""Keys that only the world of MuJoCo uses."""

from __future__ import annotations

from pydantic import Field

from robotteamsim.scenario.base import Model


class Wheels(Model):
    """The wheels of a robot's drive; they touch only the floor."""

    radius_m: float | None = Field(
        default=None,
        gt=0.005,
        le=2.0,
        description="default: a quarter of the body's half width, at most 0.4 height_m [m]",
    )
    friction: float = Field(default=0.9, gt=0.0, le=10.0, description="of a tyre on the floor, as a share of its load")


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
