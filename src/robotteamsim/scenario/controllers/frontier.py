"""The keys of `frontier`: robots that explore a building that nobody knows.

All defaults are ours, from the missions of study/unknown.
"""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import Field

from robotteamsim.scenario.base import SMALLEST
from robotteamsim.scenario.controllers.routes import RouteControl


class FrontierControl(RouteControl):
    """Drives to frontiers, where known floor ends: to the one that shows most for the length of the path there."""

    controller: ClassVar[str] = "robotteamsim.control.exploration.frontier:FrontierController"
    maps: ClassVar[tuple[str, ...]] = ("unknown",)

    algorithm: Literal["frontier"] = Field(description="frontier")
    choice: Literal["gain_over_path", "nearest", "cost_utility", "rrt"] = Field(
        default="gain_over_path",
        description="gain_over_path: the floor that may be seen from there / (path + nearness_m); "
        "nearest [yamauchi1997]; cost_utility: that floor - path_cost_m x path [burgard2005]; rrt: the same, of "
        "frontiers that a random tree finds [umari2017]",
    )
    coordinated: bool = Field(
        default=True, description="the floor around goals of teammates counts less; false: robots ignore each other"
    )
    least_gain_m2: float = Field(
        default=2.0, ge=SMALLEST, le=1e6, description="a frontier from which less may be seen is left out [m^2]"
    )
    replan_s: float = Field(
        default=4.0, ge=SMALLEST, le=600.0, description="a goal is chosen again after this time [s]"
    )
    nearness_m: float = Field(
        default=10.0,
        ge=SMALLEST,
        le=1000.0,
        description="added to the path, so that near goals do not win by much [m]",
    )
    path_cost_m: float = Field(
        default=2.0,
        ge=0.0,
        le=1000.0,
        description="with cost_utility and rrt: floor that a metre of path is worth [m^2/m]",
    )
    hysteresis: float = Field(
        default=1.2,
        ge=1.0,
        le=100.0,
        description="another goal must be this many times as good as the last one, if that is still a frontier",
    )
    rendezvous_s: float | None = Field(
        default=None,
        ge=SMALLEST,
        le=1e6,
        description="a robot that has not heard a teammate for this time, but for less than twice that, drives to the "
        "start of robot 0, where both hear each other again; null: never [s]",
    )
