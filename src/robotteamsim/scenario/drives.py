"""How robots move: the drives of a scenario."""

import math
from typing import Annotated, Literal

from pydantic import Field, Tag

from robotteamsim.scenario.base import SMALLEST, Model, by_kind


class Drive(Model):
    """A differential drive: it turns on the spot and cannot move sideways."""

    kind: Literal["differential"] = Field(default="differential", description="differential, omni or car")
    max_speed_mps: float = Field(default=0.7, ge=SMALLEST, le=10.0, description="forward and backward [m/s]")
    max_turn_radps: float = Field(default=2.0, ge=SMALLEST, le=20.0, description="turning [rad/s]")
    max_acceleration_mps2: float = Field(default=2.0, ge=SMALLEST, le=50.0, description="change of speed [m/s^2]")
    max_turn_acceleration_radps2: float = Field(
        default=8.0, ge=SMALLEST, le=200.0, description="change of turn [rad/s^2]"
    )


class OmniDrive(Model):
    """An omnidirectional drive: it moves in any direction and turns at the same time.

    Its limits apply to the lengths of the planar velocity and acceleration, not to each axis: a command beyond them
    keeps its direction.
    """

    kind: Literal["omni"] = Field(description="omni")
    max_speed_mps: float = Field(default=0.7, ge=SMALLEST, le=10.0, description="in any direction [m/s]")
    max_turn_radps: float = Field(default=2.0, ge=SMALLEST, le=20.0, description="turning [rad/s]")
    max_acceleration_mps2: float = Field(default=2.0, ge=SMALLEST, le=50.0, description="change of velocity [m/s^2]")
    max_turn_acceleration_radps2: float = Field(
        default=8.0, ge=SMALLEST, le=200.0, description="change of turn [rad/s^2]"
    )


class CarDrive(Model):
    """A car-like drive, as a bicycle: base_link is the middle of the rear axle, the front wheel steers.

    The turn of a command is the desired yaw rate: the car chooses the steering angle for its current speed, so it never
    turns on the spot.
    """

    kind: Literal["car"] = Field(description="car")
    wheelbase_m: float = Field(ge=SMALLEST, le=10.0, description="from the rear to the front axle [m]")
    max_steering_rad: float = Field(ge=SMALLEST, le=1.5, description="of the front wheel, to either side [rad]")
    max_steering_rate_radps: float = Field(default=2.0, ge=SMALLEST, le=100.0, description="change of steering [rad/s]")
    max_speed_mps: float = Field(default=0.7, ge=SMALLEST, le=10.0, description="forward and backward [m/s]")
    max_acceleration_mps2: float = Field(default=2.0, ge=SMALLEST, le=50.0, description="change of speed [m/s^2]")

    @property
    def max_turn_radps(self) -> float:
        """Yaw rate at top speed and full steering [rad/s]."""
        return self.max_speed_mps * math.tan(self.max_steering_rad) / self.wheelbase_m


AnyDrive = Annotated[
    Annotated[Drive, Tag("<differential>")] | Annotated[OmniDrive, Tag("<omni>")] | Annotated[CarDrive, Tag("<car>")],
    by_kind(default="differential"),
]
