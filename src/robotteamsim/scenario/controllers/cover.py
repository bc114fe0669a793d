"""The keys of `cover`, and of firefighters who search the floor.

All defaults are ours: no source gives these numbers.
"""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import Field

from robotteamsim.scenario.base import SMALLEST, Model
from robotteamsim.scenario.controllers.base import LinkedControl, ListeningControl


class FloorSearchTuning(Model):
    """How somebody who covers the floor chooses a goal: the place that covers the most new floor for its distance."""

    radius_m: float = Field(
        default=2.5, ge=SMALLEST, le=50.0, description="the floor within this radius is covered [m]"
    )
    nearness_m: float = Field(
        default=4.0,
        ge=SMALLEST,
        le=1000.0,
        description="the score of a place is its newly covered floor / (its distance + this value) [m]",
    )
    apart_m: float = Field(
        default=6.0,
        ge=0.0,
        le=1000.0,
        description="places within this distance of a teammate's goal are avoided [m]",
    )
    goal_timeout_s: float = Field(
        default=12.0, ge=SMALLEST, le=1e6, description="a goal without progress is given up after this time [s]"
    )
    avoided_s: float = Field(
        default=60.0, ge=0.0, le=1e6, description="a goal that was given up is avoided for this time [s]"
    )
    avoided_m: float = Field(default=3.0, ge=0.0, le=100.0, description="so are places within this distance of it [m]")


class CoverControl(FloorSearchTuning, LinkedControl, ListeningControl):
    """Covers the floor, restrained by the communication term of eq. (22), which keeps the team connected."""

    controller: ClassVar[str] = "robotteamsim.control.cover.controller:CoverController"

    algorithm: Literal["cover"] = Field(description="cover")
    speed_factor: float = Field(
        default=1.25,
        ge=1.0,
        le=10.0,
        description="robots drive faster than the swarm velocity by this factor, to arrive before the next iteration",
    )
    connected_s: float = Field(
        default=3.5,
        ge=SMALLEST,
        le=600.0,
        description="a teammate counts as connected for this time after an update [s]",
    )
    given_up_s: float = Field(
        default=90.0, ge=SMALLEST, le=1e6, description="a teammate that was not heard for longer is ignored [s]"
    )
    progress_m: float = Field(
        default=1.0, ge=SMALLEST, le=100.0, description="the path must become shorter by this within goal_timeout_s [m]"
    )
    longest_path_m: float = Field(default=200.0, ge=SMALLEST, le=10_000.0, description="limit of the path search [m]")
