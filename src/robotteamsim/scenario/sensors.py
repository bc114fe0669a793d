"""The sensors that robots can carry. Default, unit, range and meaning of every key are here and nowhere else."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Annotated, Literal, Protocol

from pydantic import AfterValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from robotteamsim.scenario.base import Model, wrong

_NAME = re.compile("[a-z][a-z0-9_]*")

_TAKEN = frozenset(
    (
        *("base", "base_laser", "base_pose_ground_truth", "base_scan", "cmd_vel", "cmd_vel_stamped", "contact"),
        *("controller", "fix", "heat", "network", "odom", "radio_map", "teleop", "voice"),
    )
)
"""Topics and frames that every robot has."""


def is_free_name(name: str) -> bool:
    """Whether a sensor may have this name."""
    return _NAME.fullmatch(name) is not None and name not in _TAKEN


def _as_topic(name: str) -> str:
    if not _NAME.fullmatch(name):
        text = f"'{name}' cannot be a topic; expected a lower-case letter, then letters, digits and _"
    elif name in _TAKEN:
        text = f"'{name}' is reserved for the robot itself"
    else:
        return name
    raise PydanticCustomError("wrong", "{text}", {"key": "", "text": text})


SensorName = Annotated[str, AfterValidator(_as_topic)]
"""The name of a sensor, its topic robot_<id>/<name> and its frame robot_<id>/<name>_link."""


class Mount(Protocol):
    """A named sensor and its pose in base_link; its x axis points to yaw_rad."""

    name: SensorName
    forward_m: float
    left_m: float
    yaw_rad: float
    height_m: float


def check_names(sensors: Mapping[str, Sequence[Mount]]) -> None:
    """Raise an error if two sensors of a robot have the same name. Args: sensors: by key."""
    seen: set[str] = set()
    for key, items in sensors.items():
        for index, item in enumerate(items):
            if item.name in seen:
                raise wrong(f"{key}.{index}.name", f"'{item.name}' is already the name of another sensor")
            seen.add(item.name)


class Laser(Model):
    """A planar laser range finder; it detects walls, doors, objects and robots."""

    beams: int = Field(default=181, ge=1, le=10_000, description="number of beams, first at angle_min")
    angle_min_rad: float = Field(default=-1.5707963267948966, ge=-6.2832, le=6.2832, description="first beam [rad]")
    angle_max_rad: float = Field(default=1.5707963267948966, ge=-6.2832, le=6.2832, description="last beam [rad]")
    range_min_m: float = Field(default=0.05, ge=0.0, le=10.0, description="shortest range [m]")
    range_max_m: float = Field(default=5.0, gt=0.0, le=200.0, description="longest range [m]")
    forward_m: float = Field(default=0.1, ge=-5.0, le=5.0, description="ahead of base_link [m]")
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


class MountedLaser(Laser):
    """An additional laser, at any pose on the robot."""

    name: SensorName = Field(description="a name, for topic robot_<id>/<name> and frame robot_<id>/<name>_link")
    left_m: float = Field(default=0.0, ge=-5.0, le=5.0, description="left of base_link [m]")
    yaw_rad: float = Field(default=0.0, ge=-6.2832, le=6.2832, description="direction of its x axis in base_link [rad]")
    every_steps: int = Field(default=1, ge=1, le=10_000, description="a scan every n-th step")


class Sonar(Model):
    """One sonar of a ring: the distance to the nearest wall, door, object or robot within a cone."""

    name: SensorName = Field(description="a name, for topic robot_<id>/<name> and frame robot_<id>/<name>_link")
    forward_m: float = Field(default=0.0, ge=-5.0, le=5.0, description="ahead of base_link [m]")
    left_m: float = Field(default=0.0, ge=-5.0, le=5.0, description="left of base_link [m]")
    yaw_rad: float = Field(default=0.0, ge=-6.2832, le=6.2832, description="its direction in base_link [rad]")
    height_m: float = Field(default=0.25, ge=0.0, le=5.0, description="above base_link, for tf [m]")
    opening_rad: float = Field(default=0.5, gt=0.0, le=3.1416, description="full angle of the cone [rad]")
    rays: int = Field(
        default=15, ge=2, le=1000, description="number of rays, spread evenly over the cone, edges included"
    )
    range_min_m: float = Field(default=0.02, ge=0.0, le=10.0, description="reading for anything nearer [m]")
    range_max_m: float = Field(default=3.0, gt=0.0, le=200.0, description="reading without a return [m]")
    noise_m: float = Field(default=0.0, ge=0.0, le=1.0, description="standard deviation of a range [m]")

    @model_validator(mode="after")
    def _check(self) -> Sonar:
        if not self.range_max_m > self.range_min_m:
            raise wrong("range_max_m", f"{self.range_max_m:g} is not above range_min_m, {self.range_min_m:g}")
        return self


class Camera(Model):
    """A camera, only in the world of MuJoCo; it shows floor, walls, doors, objects and robots, and no victims."""

    name: SensorName = Field(
        description="a name, for topics robot_<id>/<name>/image and camera_info, frames robot_<id>/<name>_link and "
        "robot_<id>/<name>_optical_frame"
    )
    images: Literal["rgb", "depth"] = Field(default="rgb", description="rgb: colours; depth: distances along its axis")
    width_px: int = Field(default=320, ge=16, le=4096, description="columns of an image")
    height_px: int = Field(default=240, ge=16, le=4096, description="rows of an image")
    fov_rad: float = Field(default=1.2, gt=0.05, le=2.8, description="horizontal angle of view [rad]")
    forward_m: float = Field(default=0.1, ge=-5.0, le=5.0, description="ahead of base_link [m]")
    left_m: float = Field(default=0.0, ge=-5.0, le=5.0, description="left of base_link [m]")
    height_m: float = Field(default=0.25, gt=0.0, le=5.0, description="above base_link [m]")
    yaw_rad: float = Field(default=0.0, ge=-6.2832, le=6.2832, description="direction in which it looks [rad]")
    every_steps: int = Field(default=5, ge=1, le=10_000, description="an image every n-th step")

    @property
    def focal_px(self) -> float:
        """Focal length, the same for columns and rows."""
        return 0.5 * self.width_px / math.tan(0.5 * self.fov_rad)


class LightSensor(Model):
    """A light sensor, only in the world of MuJoCo: the illuminance by the lights of the scenario."""

    name: SensorName = Field(description="a name, for topic robot_<id>/<name> and frame robot_<id>/<name>_link")
    forward_m: float = Field(default=0.0, ge=-5.0, le=5.0, description="ahead of base_link [m]")
    left_m: float = Field(default=0.0, ge=-5.0, le=5.0, description="left of base_link [m]")
    height_m: float = Field(default=0.3, gt=0.0, le=5.0, description="above base_link [m]")
    yaw_rad: float = Field(default=0.0, ge=-6.2832, le=6.2832, description="its direction in base_link [rad]")
    pitch_rad: float = Field(default=0.5 * math.pi, ge=-1.5708, le=1.5708, description="its direction upwards [rad]")


class Gps(Model):
    """A GPS receiver; the x axis of `map` points east, y north, and its origin is at the datum."""

    datum_lat_deg: float = Field(ge=-89.9, le=89.9, description="latitude of the origin of `map` on WGS84 [deg]")
    datum_lon_deg: float = Field(ge=-180.0, le=180.0, description="longitude of the origin of `map` on WGS84 [deg]")
    noise_m: float = Field(
        default=1.0, ge=0.0, le=1000.0, description="standard deviation to the east and to the north [m]"
    )
    rate_hz: float = Field(default=1.0, gt=0.0, le=1000.0, description="fixes per second, at most one per step [Hz]")


class HeatSensor(Model):
    """A thermal camera that looks around: the temperature at the robot, and the hot places that it sees."""

    range_m: float = Field(default=5.0, gt=0.0, le=100.0, description="farthest hot place that it sees [m]")
