"""Light sensors, in the world of MuJoCo."""

from __future__ import annotations

import math
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from robotteamsim.message_parts import RosMessage
from robotteamsim.scenario.base import SMALLEST
from robotteamsim.scenario.sensors.base import Carrier, Frame, MountedSensor, expect_within

_BRIGHTEST_LX = 1e12


class LightSensor(MountedSensor):
    """A light sensor, only in the world of MuJoCo: the illuminance by the lights of the scenario. Its reading: [lx]."""

    type_name: ClassVar[str] = "sensor_msgs/Illuminance"
    needs_mujoco: ClassVar[bool] = True

    kind: Literal["light"] = Field(default="light", description="light")
    height_m: float = Field(default=0.3, ge=SMALLEST, le=5.0, description="above base_link [m]")
    pitch_rad: float = Field(default=0.5 * math.pi, ge=-1.5708, le=1.5708, description="its direction upwards [rad]")

    def frames(self) -> tuple[Frame, ...]:
        """Return its frame, whose x axis points to yaw_rad and upwards by pitch_rad."""
        cos_yaw, sin_yaw = math.cos(0.5 * self.yaw_rad), math.sin(0.5 * self.yaw_rad)
        cos, sin = math.cos(0.5 * self.pitch_rad), math.sin(0.5 * self.pitch_rad)
        return (self._link((sin_yaw * sin, -cos_yaw * sin, sin_yaw * cos, cos_yaw * cos)),)

    def measure(self, carrier: Carrier, generator: np.random.Generator) -> float:
        """See `Sensor`."""
        return carrier.illuminance_lx(self)

    def message(self, time_ns: int, robot_id: int, reading: float) -> RosMessage:
        """See `Sensor`."""
        return {
            "header": self.header(time_ns, robot_id),
            "illuminance": reading,
            "variance": 0.0,
        }

    def text(self, reading: float) -> str:
        """See `Sensor`."""
        return f"{reading:.4g} lx"

    def reading(self, message: Any) -> float:
        """See `Sensor`."""
        return expect_within("illuminance", message.illuminance, 0.0, _BRIGHTEST_LX)
