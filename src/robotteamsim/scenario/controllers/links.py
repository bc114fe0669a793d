"""The keys of controllers that keep links to their team."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from robotteamsim.scenario.base import Model
from robotteamsim.scenario.controllers.base import Control


class LinkTuning(Model):
    """How the communication term of eq. (22) keeps links."""

    gated: bool = Field(
        default=True,
        description="the term acts only while a link is endangered; false: always, with c4, as in the printed eq. (22)",
    )
    endangered_fraction: float = Field(
        default=0.8,
        gt=0.0,
        lt=1.0,
        description="a link by distance is endangered beyond this fraction of network.max_distance_m",
    )


class LinkedControl(Control):
    """The keys of the communication term of eq. (22)."""

    c4: float = Field(
        default=0.4,
        ge=0.0,
        le=2.0,
        description="communication weight; acts while a link is endangered, or always without communication.gated",
    )
    kept_link: Literal["nearest", "tree"] = Field(
        default="nearest",
        description="link that the communication term keeps: that to the nearest teammate, or the weakest of the "
        "robot's own links in the strongest spanning tree of the team",
    )
    communication: LinkTuning = LinkTuning()
