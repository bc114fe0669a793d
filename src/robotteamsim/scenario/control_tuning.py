"""Sections of `control` with what is tuned of driving, wandering, covering, keeping links and seeing doors.

All defaults are ours: no source gives these numbers.
"""

from __future__ import annotations

from pydantic import Field, model_validator

from robotteamsim.scenario.base import Model, wrong


class NavigatorTuning(Model):
    """How a robot drives to a point: along the known map, around what its laser sees, and out of jams."""

    arrived_m: float = Field(default=0.05, gt=0.0, le=1.0, description="this near, the robot is at the point [m]")
    laser_margin_m: float = Field(
        default=0.04, ge=0.0, le=1.0, description="kept between the body and what the laser sees; below the map's [m]"
    )
    look_ahead_m: float = Field(default=0.5, gt=0.0, le=10.0, description="how far ahead must be free [m]")
    longest_path_m: float = Field(default=200.0, gt=0.0, le=10_000.0, description="no longer path is searched [m]")
    turn_in_place_rad: float = Field(
        default=0.8, gt=0.0, le=3.1416, description="a heading farther aside than this is turned to on the spot [rad]"
    )
    turn_gain_per_s: float = Field(default=3.0, gt=0.0, le=50.0, description="yaw rate per angle to the heading [1/s]")
    braking_mps2: float = Field(default=1.0, gt=0.0, le=50.0, description="planned before obstacles [m/s^2]")
    manoeuvring_mps: float = Field(default=0.3, gt=0.0, le=10.0, description="of a car that must turn far [m/s]")
    room_to_turn_m: float = Field(
        default=0.4,
        gt=0.0,
        le=10.0,
        description="with less room ahead, a car that must turn far drives back [m]",
    )
    progress_m: float = Field(default=0.2, gt=0.0, le=10.0, description="a robot that moves less is stuck [m]")
    stuck_timeout_s: float = Field(default=4.0, gt=0.0, le=600.0, description="after so long it escapes [s]")
    yield_timeout_s: float = Field(
        default=2.0,
        gt=0.0,
        le=600.0,
        description="after so long, beside a teammate of lower id: that one goes first [s]",
    )
    escape_m: float = Field(default=0.7, gt=0.0, le=10.0, description="how far an escape leads [m]")
    escape_time_s: float = Field(default=3.0, gt=0.0, le=600.0, description="an escape ends after this time [s]")
    escape_headings: int = Field(default=16, ge=1, le=360, description="directions that an escape may take")
    near_teammate_m: float = Field(
        default=1.0, gt=0.0, le=50.0, description="a teammate this near is beside the robot [m]"
    )
    nearest_free_start_m: float = Field(
        default=1.0, ge=0.0, le=10.0, description="how far from the robot a path may begin, where it has no room [m]"
    )
    nearest_free_goal_m: float = Field(
        default=3.0, ge=0.0, le=10.0, description="how far from a blocked goal a straight drive may end [m]"
    )
    sidestep_left_penalty: float = Field(
        default=0.25, ge=0.0, le=10.0, description="cost of passing on the left, against ties: all keep right [rad]"
    )
    sidestep_change_penalty: float = Field(
        default=0.35, ge=0.0, le=10.0, description="cost of changing the side, against dithering [rad]"
    )
    sidestep_ahead_rad: float = Field(
        default=1.6, gt=0.0, le=3.1416, description="obstacles are passed only by goals nearer ahead than this [rad]"
    )


class WanderTuning(Model):
    """Random straight legs over the known map: what excluded robots and `random_walk` do."""

    shortest_leg_m: float = Field(
        default=1.0, gt=0.0, le=100.0, description="no leg is shorter where there is room [m]"
    )
    longest_leg_m: float = Field(default=8.0, gt=0.0, le=1000.0, description="no leg is longer [m]")
    arrived_m: float = Field(default=0.3, gt=0.0, le=10.0, description="a leg ends this near to its end [m]")
    timeout_factor: float = Field(
        default=2.0, ge=1.0, le=100.0, description="a leg is given up after so many times its time at full speed"
    )
    timeout_s: float = Field(default=3.0, ge=0.0, le=600.0, description="time to turn, on top of timeout_factor [s]")

    @model_validator(mode="after")
    def _check(self) -> WanderTuning:
        if self.longest_leg_m < self.shortest_leg_m:
            raise wrong("longest_leg_m", f"{self.longest_leg_m:g} is below shortest_leg_m, {self.shortest_leg_m:g}")
        return self


class CoverTuning(Model):
    """How `cover` chooses where to go: the place that covers most for the path to it."""

    radius_m: float = Field(default=2.5, gt=0.0, le=50.0, description="what a robot covers around it [m]")
    nearness_m: float = Field(
        default=4.0,
        gt=0.0,
        le=1000.0,
        description="a place is worth what it newly covers / (its distance + this) [m]",
    )
    apart_m: float = Field(
        default=6.0, ge=0.0, le=1000.0, description="places nearer than this to a teammate's goal are left to it [m]"
    )
    connected_s: float = Field(
        default=3.5, gt=0.0, le=600.0, description="a teammate is connected this long after its last update [s]"
    )
    given_up_s: float = Field(
        default=90.0, gt=0.0, le=1e6, description="a teammate unheard for longer no longer holds the robot back [s]"
    )
    progress_m: float = Field(
        default=1.0, gt=0.0, le=100.0, description="by how much a goal must come nearer within goal_timeout_s [m]"
    )
    goal_timeout_s: float = Field(default=12.0, gt=0.0, le=1e6, description="without progress, a goal is avoided [s]")
    avoided_s: float = Field(default=60.0, ge=0.0, le=1e6, description="how long a goal is avoided [s]")
    avoided_m: float = Field(default=3.0, ge=0.0, le=100.0, description="so are places this near to it [m]")
    longest_path_m: float = Field(default=200.0, gt=0.0, le=10_000.0, description="no longer path is searched [m]")


class LinkTuning(Model):
    """How links are kept, by the communication term of eq. (22)."""

    gated: bool = Field(
        default=True,
        description="the term acts only where a link is endangered; false: always, with c4, as eq. (22) is printed",
    )
    endangered_fraction: float = Field(
        default=0.8,
        gt=0.0,
        lt=1.0,
        description="a link by distance that is longer than this part of network.max_distance_m is endangered",
    )


class DoorTuning(Model):
    """How a robot tells from its laser whether a door is open or closed."""

    leaf_tolerance_m: float = Field(
        default=0.12, gt=0.0, le=1.0, description="a beam that ends this near to the closed leaf ends at it [m]"
    )
    fewest_beams: int = Field(default=5, ge=1, le=10_000, description="beams that must agree on a leaf")
    clear_majority: float = Field(
        default=0.8, gt=0.5, le=1.0, description="part of the beams on a leaf that must agree on it"
    )
