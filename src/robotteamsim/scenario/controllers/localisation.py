"""The section `control.laser_localisation`: how robots find out where they are in a known building.

All defaults are ours, from the missions of study/unknown.
"""

from __future__ import annotations

from pydantic import Field

from robotteamsim.scenario.base import SMALLEST, Model


class LaserLocalisation(Model):
    """With `localisation: laser`: particles that odometry moves and laser scans weigh, and what a lost robot does."""

    particles: int = Field(default=200, ge=200, le=10_000, description="number of particles of each robot")
    beams: int = Field(default=31, ge=5, le=10_000, description="number of beams of a scan that weigh them")
    cell_m: float = Field(default=0.05, ge=0.01, le=1.0, description="cells of the map in which beams are traced [m]")
    update_m: float = Field(default=0.1, ge=SMALLEST, le=10.0, description="distance driven between two scans [m]")
    update_rad: float = Field(default=0.1, ge=SMALLEST, le=3.1416, description="or turn between them [rad]")
    start_m: float = Field(default=0.1, ge=0.0, le=10.0, description="standard deviation of the known start [m]")
    start_rad: float = Field(default=0.05, ge=0.0, le=3.1416, description="standard deviation of its heading [rad]")
    sigma_m: float = Field(
        default=0.1,
        ge=SMALLEST,
        le=10.0,
        description="standard deviation of a range, for the laser's noise, the map's cells and what the map lacks [m]",
    )
    outliers: float = Field(
        default=0.05,
        ge=SMALLEST,
        lt=1.0,
        description="likelihood of a range that does not fit, relative to one that fits; people and objects are not "
        "in the map",
    )
    power: float = Field(
        default=0.3,
        ge=SMALLEST,
        le=1.0,
        description="exponent of a scan's likelihood: beams next to each other are not independent",
    )
    window_m: float = Field(
        default=10.0, ge=0.5, le=1000.0, description="scans of the last so many metres decide whether it is lost [m]"
    )
    lost_fraction: float = Field(
        default=0.4,
        gt=0.0,
        lt=1.0,
        description="a robot is lost if more of the beams that should or do hit something contradict the map",
    )
    fits_fraction: float = Field(
        default=0.1, gt=0.0, lt=1.0, description="a place that was found is given up if more of the beams contradict"
    )
    tolerance_m: float = Field(
        default=0.3, ge=SMALLEST, le=10.0, description="a range that differs less from the map does not contradict [m]"
    )
    tolerance_rad: float = Field(
        default=0.05, ge=0.0, le=0.5, description="nor one that fits in a direction this near [rad]"
    )
    search_every_m: float = Field(
        default=2.0, ge=0.1, le=1000.0, description="a lost robot searches the plan again after driving so far [m]"
    )
    submap_m: float = Field(
        default=10.0, ge=0.5, le=1000.0, description="length driven whose scans it searches for in the plan [m]"
    )
    submap_points: int = Field(default=200, ge=30, le=10_000, description="number of points that it searches for")
    found_fraction: float = Field(
        default=0.5, gt=0.0, le=1.0, description="of these must lie on walls, for a place to count"
    )
    confirm_m: float = Field(
        default=5.0, ge=0.0, le=1000.0, description="a place found is believed after driving so far in agreement [m]"
    )
