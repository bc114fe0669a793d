"""Sonars: the range of the nearest obstacle within a cone."""

from __future__ import annotations

import math
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from robotteamsim.message_parts import RosMessage
from robotteamsim.scenario.base import SMALLEST, wrong
from robotteamsim.scenario.sensors.base import BeamModel, Carrier, Fan, MountedSensor

_ULTRASOUND = 0  # constant of sensor_msgs/Range


class Sonar(MountedSensor):
    """One sonar of a ring: the distance to the nearest wall, door, object or robot within a cone. Its reading: [m].

    It reads the shortest of the rays in its cone, which are cast like a laser's beams; obstacles narrower than the gap
    between two rays may be missed. Smoke does not stop ultrasound.
    """

    type_name: ClassVar[str] = "sensor_msgs/Range"

    kind: Literal["sonar"] = Field(default="sonar", description="sonar")
    opening_rad: float = Field(default=0.5, ge=SMALLEST, le=3.1416, description="full angle of the cone [rad]")
    rays: int = Field(
        default=15, ge=2, le=1000, description="number of rays, spread evenly over the cone, edges included"
    )
    range_min_m: float = Field(default=0.02, ge=0.0, le=10.0, description="reading for anything nearer [m]")
    range_max_m: float = Field(default=3.0, ge=SMALLEST, le=200.0, description="reading without a return [m]")
    noise_m: float = Field(default=0.0, ge=0.0, le=1.0, description="standard deviation of a range [m]")

    @model_validator(mode="after")
    def _check(self) -> Sonar:
        if not self.range_max_m > self.range_min_m:
            raise wrong("range_max_m", f"{self.range_max_m:g} is not above range_min_m, {self.range_min_m:g}")
        return self

    def measure(self, carrier: Carrier, generator: np.random.Generator) -> float:
        """See `Sensor`."""
        fan = Fan(
            beams=self.rays,
            angle_min_rad=self.yaw_rad - 0.5 * self.opening_rad,
            angle_max_rad=self.yaw_rad + 0.5 * self.opening_rad,
            forward_m=self.forward_m,
            left_m=self.left_m,
            height_m=self.height_m,
            range_max_m=self.range_max_m,
        )
        beams = BeamModel(fan, self.range_min_m, too_near_m=self.range_min_m, no_return_m=self.range_max_m)
        noise_m = generator.normal(0.0, self.noise_m, 1) if self.noise_m > 0.0 else np.empty(0)
        return carrier.nearest_m(beams, noise_m)

    def message(self, time_ns: int, robot_id: int, reading: float) -> RosMessage:
        """See `Sensor`."""
        return {
            "header": self.header(time_ns, robot_id),
            "radiation_type": _ULTRASOUND,
            "field_of_view": self.opening_rad,
            "min_range": self.range_min_m,
            "max_range": self.range_max_m,
            "range": reading,
        }

    def text(self, reading: float) -> str:
        """See `Sensor`."""
        return f"{reading:.2f} m" if math.isfinite(reading) else "nothing"

    def reading(self, message: Any) -> float:
        """See `Sensor`."""
        if math.isnan(message.range):  # infinity is a valid range (REP-117)
            raise ValueError("range: nan; expected a number")
        return float(message.range)
