"""Sections of `control` with tuning parameters of driving, wandering and door detection.

All defaults are ours: no source gives these numbers.
"""

from __future__ import annotations

from pydantic import Field, model_validator

from robotteamsim.scenario.base import SMALLEST, Model, wrong


class NavigatorTuning(Model):
    """How a robot drives to a point: along the known map, around obstacles that its laser sees, and out of jams."""

    arrived_m: float = Field(
        default=0.05, ge=SMALLEST, le=1.0, description="distance at which the robot has reached the point [m]"
    )
    laser_margin_m: float = Field(
        default=0.04,
        ge=0.0,
        le=1.0,
        description="clearance between the body and obstacles seen by the laser; smaller than that of the map [m]",
    )
    look_ahead_m: float = Field(default=0.5, ge=SMALLEST, le=10.0, description="distance ahead that must be free [m]")
    longest_path_m: float = Field(default=200.0, ge=SMALLEST, le=10_000.0, description="limit of the path search [m]")
    turn_in_place_rad: float = Field(
        default=0.8, ge=SMALLEST, le=3.1416, description="beyond this heading error the robot turns on the spot [rad]"
    )
    turn_gain_per_s: float = Field(default=3.0, ge=SMALLEST, le=50.0, description="yaw rate per heading error [1/s]")
    braking_mps2: float = Field(
        default=1.0, ge=SMALLEST, le=50.0, description="planned deceleration before obstacles [m/s^2]"
    )
    manoeuvring_mps: float = Field(
        default=0.3, ge=SMALLEST, le=10.0, description="speed of a car with a large heading error [m/s]"
    )
    room_to_turn_m: float = Field(
        default=0.4,
        ge=SMALLEST,
        le=10.0,
        description="with less room ahead, a car with a large heading error drives backward [m]",
    )
    progress_m: float = Field(
        default=0.2, ge=SMALLEST, le=10.0, description="a robot that moves less within stuck_timeout_s is stuck [m]"
    )
    stuck_timeout_s: float = Field(
        default=4.0, ge=SMALLEST, le=600.0, description="a robot without progress escapes after this time [s]"
    )
    yield_timeout_s: float = Field(
        default=2.0,
        ge=SMALLEST,
        le=600.0,
        description="the same next to a teammate with a lower id, which has the right of way [s]",
    )
    escape_m: float = Field(default=0.7, ge=SMALLEST, le=10.0, description="length of an escape [m]")
    escape_time_s: float = Field(default=3.0, ge=SMALLEST, le=600.0, description="longest duration of an escape [s]")
    escape_headings: int = Field(default=16, ge=1, le=360, description="number of directions tried for an escape")
    near_teammate_m: float = Field(
        default=1.0, ge=SMALLEST, le=50.0, description="a teammate within this distance is next to the robot [m]"
    )
    nearest_free_start_m: float = Field(
        default=1.0,
        ge=0.0,
        le=10.0,
        description="how far from the robot a path may start if the robot is too close to a wall [m]",
    )
    nearest_free_goal_m: float = Field(
        default=3.0, ge=0.0, le=10.0, description="how far from a blocked goal a straight path may end [m]"
    )
    sidestep_left_penalty: float = Field(
        default=0.25, ge=0.0, le=10.0, description="cost of passing on the left, so that all robots keep right [rad]"
    )
    sidestep_change_penalty: float = Field(
        default=0.35, ge=0.0, le=10.0, description="cost of changing the side, so that a robot does not dither [rad]"
    )
    sidestep_ahead_rad: float = Field(
        default=1.6,
        ge=SMALLEST,
        le=3.1416,
        description="the robot sidesteps only for goals within this angle ahead [rad]",
    )


class WanderTuning(Model):
    """Random straight legs over the known map: what excluded robots and `random_walk` do."""

    shortest_leg_m: float = Field(
        default=1.0, ge=SMALLEST, le=100.0, description="shortest leg, unless there is less room [m]"
    )
    longest_leg_m: float = Field(default=8.0, ge=SMALLEST, le=1000.0, description="longest leg [m]")
    arrived_m: float = Field(
        default=0.3, ge=SMALLEST, le=10.0, description="distance at which the robot has reached the end of a leg [m]"
    )
    timeout_factor: float = Field(
        default=2.0, ge=1.0, le=100.0, description="a leg is given up after this multiple of its time at full speed"
    )
    timeout_s: float = Field(
        default=3.0, ge=0.0, le=600.0, description="added to that time, so that the robot can turn [s]"
    )

    @model_validator(mode="after")
    def _check(self) -> WanderTuning:
        if self.longest_leg_m < self.shortest_leg_m:
            raise wrong("longest_leg_m", f"{self.longest_leg_m:g} is below shortest_leg_m, {self.shortest_leg_m:g}")
        return self


class DoorTuning(Model):
    """How a robot detects with its laser whether a door is open or closed."""

    leaf_tolerance_m: float = Field(
        default=0.12,
        ge=SMALLEST,
        le=1.0,
        description="a beam that ends within this distance of the closed leaf counts as hitting it [m]",
    )
    fewest_beams: int = Field(default=5, ge=1, le=10_000, description="number of beams that must agree")
    clear_majority: float = Field(
        default=0.8, gt=0.5, le=1.0, description="fraction of the beams towards the leaf that must agree"
    )
