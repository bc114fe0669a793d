"""The keys of the controllers that follow a route over the plan: `boustrophedon` and `infotaxis`.

All defaults are ours: no source gives these numbers.
"""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import Field

from robotteamsim.scenario.base import SMALLEST
from robotteamsim.scenario.controllers.base import ListeningControl


class RouteControl(ListeningControl):
    """The keys of both controllers: when a robot gives up a place or a voice."""

    arrived_m: float = Field(
        default=0.5, ge=SMALLEST, le=10.0, description="a place of the route counts as reached [m]"
    )
    timeout_factor: float = Field(
        default=4.0, ge=1.0, le=100.0, description="a place is given up after this multiple of the travel time to it"
    )
    timeout_s: float = Field(default=10.0, ge=0.0, le=1e6, description="added to that time [s]")
    voice_timeout_s: float = Field(
        default=10.0,
        ge=SMALLEST,
        le=1e6,
        description="a voice that does not become louder for this time is ignored near that place [s]",
    )


class BoustrophedonControl(RouteControl):
    """Sweeps the floor in parallel lines."""

    controller: ClassVar[str] = "robotteamsim.control.baselines.boustrophedon:BoustrophedonController"

    algorithm: Literal["boustrophedon"] = Field(description="boustrophedon")
    spacing_m: float = Field(default=4.0, ge=0.5, le=100.0, description="between neighbouring lines [m]")


class InfotaxisControl(RouteControl):
    """Moves where it expects to learn most about the victims' places."""

    controller: ClassVar[str] = "robotteamsim.control.baselines.infotaxis:InfotaxisController"

    algorithm: Literal["infotaxis"] = Field(description="infotaxis")
    spacing_m: float = Field(
        default=2.0, ge=0.5, le=100.0, description="of the lattice of places at which a victim may be [m]"
    )
    missed: float = Field(
        default=0.02, ge=SMALLEST, lt=1.0, description="probability that a voice which should be heard is not heard"
    )
    least_gain_nats: float = Field(
        default=0.02,
        ge=0.0,
        le=100.0,
        description="if every neighbouring place reduces the entropy by less, the robot drives to a likely place [nat]",
    )
