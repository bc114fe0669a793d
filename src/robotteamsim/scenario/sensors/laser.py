"""The laser range finder, which detects walls, doors, objects and other robots."""

from __future__ import annotations

import math
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from robotteamsim.message_parts import RosMessage
from robotteamsim.scenario.base import SMALLEST, Model, wrong
from robotteamsim.scenario.sensors.base import BeamModel, Carrier, Fan, Moment, MountedSensor


class Laser(Model):
    """A planar laser range finder; it detects walls, doors, objects and robots."""

    beams: int = Field(default=181, ge=1, le=10_000, description="number of beams, the first or only one at angle_min")
    angle_min_rad: float = Field(default=-1.5707963267948966, ge=-6.2832, le=6.2832, description="first beam [rad]")
    angle_max_rad: float = Field(default=1.5707963267948966, ge=-6.2832, le=6.2832, description="last beam [rad]")
    range_min_m: float = Field(default=0.05, ge=0.0, le=10.0, description="shortest range [m]")
    range_max_m: float = Field(default=5.0, ge=SMALLEST, le=200.0, description="longest range [m]")
    forward_m: float = Field(default=0.1, ge=-5.0, le=5.0, description="ahead of base_link [m]")
    left_m: float = Field(default=0.0, ge=-5.0, le=5.0, description="left of base_link [m]")
    height_m: float = Field(default=0.25, ge=0.0, le=2.0, description="above base_link, for tf [m]")
    no_return: Literal["range_max", "inf"] = Field(
        default="range_max", description="range without a return: range_max as in Stage, or inf as in REP-117"
    )
    noise_m: float = Field(default=0.0, ge=0.0, le=1.0, description="standard deviation of a range [m]")

    @model_validator(mode="after")
    def _check(self) -> Laser:
        if not self.angle_max_rad > self.angle_min_rad:
            raise wrong("angle_max_rad", f"{self.angle_max_rad:g} is not above angle_min_rad, {self.angle_min_rad:g}")
        if not self.range_max_m > self.range_min_m:
            raise wrong("range_max_m", f"{self.range_max_m:g} is not above range_min_m, {self.range_min_m:g}")
        return self

    @property
    def angles_rad(self) -> np.ndarray:
        """The directions of the beams from straight ahead, counter-clockwise, float64, shape (beams,) [rad]."""
        return np.linspace(self.angle_min_rad, self.angle_max_rad, self.beams)

    def beam_model(self, yaw_rad: float = 0.0) -> BeamModel:
        """Return its beams. Without a return they read range_max, or +inf; too near range_min, or -inf (REP-117)."""
        as_rep_117 = self.no_return == "inf"
        fan = Fan(
            beams=self.beams,
            angle_min_rad=yaw_rad + self.angle_min_rad,
            angle_max_rad=yaw_rad + self.angle_max_rad,
            forward_m=self.forward_m,
            left_m=self.left_m,
            height_m=self.height_m,
            range_max_m=self.range_max_m,
        )
        return BeamModel(
            fan=fan,
            range_min_m=self.range_min_m,
            too_near_m=-math.inf if as_rep_117 else self.range_min_m,
            no_return_m=math.inf if as_rep_117 else self.range_max_m,
        )

    def scan(self, header: Any, ranges_m: np.ndarray, scan_s: float) -> RosMessage:
        """sensor_msgs/LaserScan. Args: scan_s: time between two scans [s]."""
        return {
            "header": header,
            "angle_min": self.angle_min_rad,
            "angle_max": self.angle_max_rad if self.beams > 1 else self.angle_min_rad,
            "angle_increment": (self.angle_max_rad - self.angle_min_rad) / max(self.beams - 1, 1),
            "scan_time": scan_s,
            "range_min": self.range_min_m,
            "range_max": self.range_max_m,
            "ranges": np.asarray(ranges_m, dtype=np.float32),
        }

    def ranges_m(self, message: Any) -> np.ndarray:
        """Return the ranges of a sensor_msgs/LaserScan, float32, shape (beams,). Raises: ValueError: another number."""
        if len(message.ranges) != self.beams:
            count = len(message.ranges)
            raise ValueError(f"ranges: {count} entries; expected {self.beams}, the beams of the scenario's laser")
        return np.asarray(message.ranges, dtype=np.float32)


class MountedLaser(Laser, MountedSensor):
    """An additional laser, at any pose on the robot. Its reading: ranges, float32, shape (beams,) [m]."""

    type_name: ClassVar[str] = "sensor_msgs/LaserScan"

    kind: Literal["laser"] = Field(default="laser", description="laser")
    every_steps: int = Field(default=1, ge=1, le=10_000, description="a scan every n-th step")

    def is_due(self, moment: Moment) -> bool:
        """See `Sensor`."""
        return moment.step_index % self.every_steps == 0

    def measure(self, carrier: Carrier, generator: np.random.Generator) -> np.ndarray:
        """See `Sensor`."""
        noise_m = generator.normal(0.0, self.noise_m, self.beams) if self.noise_m > 0.0 else np.empty(0)
        return carrier.ranges_m(self.beam_model(self.yaw_rad), noise_m)

    def message(self, time_ns: int, robot_id: int, reading: np.ndarray, step_s: float = 0.0) -> RosMessage:
        """See `Sensor`."""
        return self.scan(self.header(time_ns, robot_id), reading, self.every_steps * step_s)

    def messages(self, time_ns: int, robot_id: int, reading: np.ndarray, step_s: float = 0.0) -> dict[str, RosMessage]:
        """See `Sensor`."""
        return {self.name: self.message(time_ns, robot_id, reading, step_s)}

    def text(self, reading: np.ndarray) -> str:
        """See `Sensor`."""
        returned_m = reading[np.isfinite(reading)]
        return f"nearest {returned_m.min():.2f} m" if len(returned_m) else "nothing"

    def reading(self, message: Any) -> np.ndarray:
        """See `Sensor`."""
        return self.ranges_m(message)
