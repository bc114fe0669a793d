"""The keys of `search`: what a team that searches assumes, and when it stops.

All defaults are ours: no source gives these numbers.
"""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import Field, model_validator

from robotteamsim.scenario.base import SMALLEST, NoiseDb, wrong
from robotteamsim.scenario.controllers.base import Control
from robotteamsim.scenario.controllers.driving import DoorTuning

_MOST_LINKED_CELLS = 10_000
"""The predicted links between so many cells have 200 MB, for each state of the doors."""


class SearchControl(Control):
    """Chooses where to listen by Bayesian search, until nothing is worth the time any more."""

    controller: ClassVar[str] = "robotteamsim.control.search.controller:SearchController"
    drives_to_areas: ClassVar[bool] = True
    values_areas: ClassVar[bool] = True

    algorithm: Literal["search"] = Field(description="search")
    doors: DoorTuning = DoorTuning()
    network: Literal["free", "connected"] = Field(
        default="free",
        description="connected: goals and paths keep the team in one radio network; free: links do not matter",
    )
    link_margin_db: float = Field(
        default=3.0,
        ge=0.0,
        le=100.0,
        description="with network connected, a predicted link must be this much above network.lost_below_dbm [dB]",
    )
    cell_m: float = Field(default=1.0, ge=0.25, le=100.0, description="cell of the belief [m]")
    most_cells: int = Field(
        default=6000,
        ge=100,
        le=65_536,
        description="largest number of cells; for a larger plan, cell_m is doubled until they fit",
    )
    expected_victims: float = Field(
        default=4.0,
        ge=SMALLEST,
        le=10_000.0,
        description="how many victims the robots expect before they have found any",
    )
    assumed_noise_db: NoiseDb = Field(
        default=30.0, description="noise that robots assume until the first voice shows how loud it is [dB]"
    )
    victim_worth_s: float = Field(
        default=1500.0,
        ge=SMALLEST,
        le=1e9,
        description="time of one robot that a victim is worth: a place whose expected victims per second of travel are "
        "below 1 / this value is not searched [s]",
    )
    delay_s: float = Field(
        default=3.0,
        ge=SMALLEST,
        le=600.0,
        description="added to the travel time to a place, so that far places count [s]",
    )
    place_spacing_m: float = Field(default=2.0, ge=SMALLEST, le=100.0, description="between places to listen at [m]")
    choose_s: float = Field(
        default=2.0, ge=SMALLEST, le=600.0, description="a robot compares all places at this interval [s]"
    )
    better: float = Field(
        default=1.3, ge=1.0, le=100.0, description="a robot leaves its goal for a place that is better by this factor"
    )
    detour_s: float = Field(
        default=6.0,
        ge=0.0,
        le=1e6,
        description="an area is explored as soon as that costs a robot no more than this detour [s]",
    )
    reserve: float = Field(
        default=1.3,
        ge=1.0,
        le=10.0,
        description="areas become urgent when the time left is below this multiple of the time to drive to all of them",
    )
    reserve_s: float = Field(default=20.0, ge=0.0, le=1e6, description="added to that time [s]")
    given_up_s: float = Field(
        default=30.0, ge=SMALLEST, le=1e6, description="a teammate that was not heard for longer is ignored [s]"
    )
    same_voice_m: float = Field(
        default=6.0, ge=0.0, le=1000.0, description="voices whose sources seem to be this near are one voice [m]"
    )
    progress_timeout_s: float = Field(
        default=20.0,
        ge=SMALLEST,
        le=1e6,
        description="a goal to which the path does not become shorter is given up [s]",
    )
    avoided_s: float = Field(
        default=60.0, ge=0.0, le=1e6, description="a goal that was given up is avoided for this time [s]"
    )
    shared_places: int = Field(
        default=60,
        ge=1,
        le=10_000,
        description="largest number of places at which the robot listened in one message",
    )
    repeated_places: int = Field(
        default=12,
        ge=0,
        le=10_000,
        description="number of known places that each message repeats, in turn, for robots that missed them",
    )

    @model_validator(mode="after")
    def _check(self) -> SearchControl:
        if self.network == "connected" and self.most_cells > _MOST_LINKED_CELLS:
            raise wrong("most_cells", f"{self.most_cells} is above {_MOST_LINKED_CELLS}, with network connected")
        return self
