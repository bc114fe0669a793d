"""The keys of the controllers that patrol the graph of `mission.patrol`."""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import Field

from robotteamsim.scenario.base import SMALLEST
from robotteamsim.scenario.controllers.base import Control


class PatrolControl(Control):
    """The keys of both controllers."""

    patrols: ClassVar[bool] = True

    timeout_factor: float = Field(
        default=4.0, ge=1.0, le=100.0, description="a robot chooses again after this multiple of its travel time"
    )
    timeout_s: float = Field(default=10.0, ge=0.0, le=1e6, description="added to that time [s]")


class ConscientiousReactiveControl(PatrolControl):
    """Goes to the neighbour that it has not visited for the longest time [machado2002]."""

    controller: ClassVar[str] = "robotteamsim.control.baselines.conscientious:ConscientiousReactiveController"

    algorithm: Literal["conscientious_reactive"] = Field(description="conscientious_reactive")


class SebsControl(PatrolControl):
    """SEBS: patrol by state exchange [portugal2013]."""

    controller: ClassVar[str] = "robotteamsim.control.baselines.sebs:SebsController"

    algorithm: Literal["sebs"] = Field(description="sebs")
    g1: float = Field(default=0.1, ge=SMALLEST, lt=1.0, description="G1: probability of a vertex without gain")
    g2: float = Field(
        default=100.0, ge=SMALLEST, le=1e6, description="G2: gain at which the probability reaches 1 [s/m]"
    )
    edge_min_m: float = Field(
        default=1.0, ge=SMALLEST, le=100.0, description="lower limit of the lengths of edges in the gain [m]"
    )
