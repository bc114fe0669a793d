"""Firefighters: a team of people with a body in the world, as robots have one."""

from __future__ import annotations

from pydantic import Field

from robotteamsim.scenario.base import SMALLEST
from robotteamsim.scenario.controllers.cover import FloorSearchTuning
from robotteamsim.scenario.drives import AnyDrive, OmniDrive
from robotteamsim.scenario.rescue import Dispatch
from robotteamsim.scenario.sections import Laser, PlacedRobot, Team

_WALK = OmniDrive(
    kind="omni",
    max_speed_mps=1.3,
    max_turn_radps=3.0,
    max_acceleration_mps2=3.0,
    max_turn_acceleration_radps2=20.0,
)


class Firefighters(Team):
    """People who search, follow the orders of the command centre, and carry or lead victims to safety.

    Their body moves like that of an omnidirectional robot; the laser stands for their eyes, which see obstacles.
    """

    count: int = Field(default=3, ge=1, le=100, description="number of firefighters; their ids follow the robots'")
    radius_m: float = Field(default=0.25, gt=0.02, le=5.0, description="of the body [m]")
    height_m: float = Field(default=1.8, ge=SMALLEST, le=5.0, description="for 3D views [m]")
    mass_kg: float = Field(default=100.0, ge=SMALLEST, le=10_000.0, description="with equipment, for pushing [kg]")
    drive: AnyDrive = Field(default=_WALK, description="how they walk")
    escort_speed_mps: float = Field(
        default=0.6, ge=SMALLEST, le=10.0, description="speed with a victim, whom they carry or lead [m/s]"
    )
    breathing_apparatus: bool = Field(
        default=True, description="whether they breathe clean air from a bottle, so that only heat harms them"
    )
    block_c: float = Field(
        default=100.0,
        ge=0.0,
        le=2000.0,
        description="those who sense heat avoid places as hot as this; turnout gear protects for 25 min at 100 degC "
        "(thermal class I), for 15 min at 160 degC (class II) [donnelly2006]; at least `fire.heat.block_c`, for robots "
        "[degC]",
    )
    searches: bool = Field(default=True, description="whether they search the floor while they have no order")
    floor_search: FloorSearchTuning = FloorSearchTuning()
    dispatch: Dispatch = Dispatch()


def centre_body(place: tuple[float, float] = (0.0, 0.0)) -> PlacedRobot:
    """Return the body of a command centre at a place: it stands still, and nobody can push it away."""
    return PlacedRobot(
        radius_m=0.3, height_m=1.2, mass_kg=10_000.0, laser=Laser(beams=1), start_pose=(place[0], place[1], 0.0)
    )
