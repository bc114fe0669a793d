"""The section `control.mapping`: how robots map a building that they do not know.

All defaults are ours, from the missions of study/unknown.
"""

from __future__ import annotations

from typing import Literal

from pydantic import Field, field_validator

from robotteamsim.scenario.base import SMALLEST, Model, wrong

SHARED_CELL_M = 0.1
"""Edge of a cell of the maps that robots share, and plan on [m]."""


class Mapping(Model):
    """With `map: unknown`: when a robot inserts a scan into its map, and how it matches it with the map before."""

    cell_m: float = Field(
        default=0.05, ge=0.01, le=SHARED_CELL_M, description="cell of the map [m]; 0.1 is a multiple of it"
    )
    update_m: float = Field(default=0.2, ge=SMALLEST, le=10.0, description="distance driven between two scans [m]")
    update_rad: float = Field(
        default=0.1,
        ge=SMALLEST,
        le=3.1416,
        description="or turn between them [rad]; larger turns have errors from which no match returns",
    )
    beams: int = Field(
        default=181, ge=5, le=10_000, description="of a scan with more beams than this, only every n-th is used"
    )
    reach_m: float = Field(
        default=0.3, ge=SMALLEST, le=10.0, description="how far from a hit its wall is looked for in the map [m]"
    )
    kernel_m: float = Field(
        default=0.07,
        ge=SMALLEST,
        le=10.0,
        description="standard deviation of the weights of the map's hits around it, by their distance [m]",
    )
    sigma_m: float = Field(
        default=0.02, ge=SMALLEST, le=10.0, description="standard deviation of a hit from its wall [m]"
    )
    outlier_m: float = Field(
        default=0.03, ge=SMALLEST, le=10.0, description="a hit this far from its wall has half the weight [m]"
    )
    share_s: float = Field(
        default=4.0,
        ge=SMALLEST,
        le=1000.0,
        description="time between two messages with what a robot has mapped [s]",
    )
    starts: Literal["known", "unknown"] = Field(
        default="known",
        description="unknown: robot 0 and the base alone know where they start; the others find out when walls and the "
        "sight of teammates agree",
    )
    submap_m: float = Field(default=6.0, ge=0.5, le=1000.0, description="length driven in one submap [m]")
    lost_share: float = Field(
        default=0.4,
        gt=0.0,
        lt=1.0,
        description="a robot is lost if, over the last metres, more of the hits in known places contradict its map",
    )

    @field_validator("cell_m")
    @classmethod
    def _check_cell(cls, cell_m: float) -> float:
        cells = SHARED_CELL_M / cell_m
        if abs(cells - round(cells)) > 1e-6:
            raise wrong("", f"{cell_m:g} is not {SHARED_CELL_M:g} divided by a whole number")
        return cell_m
