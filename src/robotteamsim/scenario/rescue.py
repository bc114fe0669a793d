"""Victims who are brought to safety: exits, how people walk, and how firefighters are sent to them."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag

from robotteamsim.scenario.base import SMALLEST, Model, Name, Point, wrong
from robotteamsim.scenario.yaml_text import shown


def _centre_form(value: Any) -> str:
    return "<id>" if isinstance(value, int | float) else "<place>"


def _check_centre(value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, (int, float, list, tuple)):
        raise wrong("", f"{shown(value)} is neither a robot nor a place; expected the id of a robot, or [x, y]")
    return value


CommandCentre = Annotated[
    Annotated[Annotated[int, Field(ge=0, le=2999)], Tag("<id>")] | Annotated[Point, Tag("<place>")],
    Discriminator(_centre_form),
    BeforeValidator(_check_centre),
]
"""The id of a robot, or [x, y] in the map frame [m]."""


class Exit(Model):
    """A place where people are safe; they flee to it as long as a path is open."""

    name: Name = Field(description="a name, unique among exits")
    center: Point = Field(description="[x, y] in the map frame [m]")
    radius_m: float = Field(default=1.0, ge=SMALLEST, le=100.0, description="people within this distance are safe [m]")


class Rescue(Model):
    """How robots and firefighters find victims, and firefighters save them, with `saved_by: firefighter`."""

    sight_m: float = Field(
        default=8.0, ge=0.0, le=1000.0, description="a victim in line of sight is located within this distance [m]"
    )
    sight_error: float = Field(
        default=0.02, ge=0.0, le=1.0, description="standard deviation of the seen position per distance [m/m]"
    )
    located_voice_db: float = Field(
        default=50.0, ge=0.0, le=200.0, description="a voice with this level nearby locates the victim [dB]"
    )
    moved_m: float = Field(
        default=1.5,
        ge=SMALLEST,
        le=100.0,
        description="a victim who is seen farther from the last position is news [m]",
    )
    pick_up_s: float = Field(
        default=5.0, ge=0.0, le=3600.0, description="from reaching a victim until they leave together [s]"
    )
    safe_m: float = Field(
        default=2.0,
        ge=SMALLEST,
        le=100.0,
        description="victims within this distance of the command centre are safe [m]",
    )


class Relays(Model):
    """Robots that connect the command centre or base, firefighters and searchers."""

    count: int = Field(default=0, ge=0, le=3000, description="number of robots that are relays, the last ones")
    given_up_s: float = Field(
        default=90.0, ge=SMALLEST, le=1e6, description="whoever was not heard for longer is not connected any more [s]"
    )


class Dispatch(Model):
    """How the command centre sends firefighters to victims."""

    method: Literal["auction", "hungarian"] = Field(
        default="auction",
        description="auction: bids with prices, within 0.1 m of the best total; hungarian: the best, by SciPy",
    )
    keep_m: float = Field(
        default=5.0,
        ge=0.0,
        le=1000.0,
        description="a firefighter keeps a victim unless another assignment is shorter by more than this [m]",
    )
    contact_timeout_s: float = Field(
        default=5.0, ge=SMALLEST, le=1e6, description="without news for this time, contact is lost [s]"
    )
    alone_s: float = Field(
        default=60.0,
        ge=SMALLEST,
        le=1e6,
        description="a firefighter who searches without contact for this time returns to where it was lost [s]",
    )
    given_up_s: float = Field(
        default=180.0,
        ge=SMALLEST,
        le=1e6,
        description="without contact for this time, the victim of a firefighter is assigned to another [s]",
    )
    look_around_s: float = Field(
        default=10.0,
        ge=SMALLEST,
        le=3600.0,
        description="a firefighter who finds nobody there, nor near it, gives up after this time [s]",
    )
    feel_m: float = Field(
        default=4.0,
        ge=SMALLEST,
        le=20.0,
        description="within this distance of the place they feel their way; a voice of 50 dB is at most 3.6 m off [m]",
    )
    feel_s: float = Field(default=30.0, ge=0.0, le=3600.0, description="they do so for at most this time [s]")
