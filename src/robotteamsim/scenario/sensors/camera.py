"""Cameras, in the world of MuJoCo."""

from __future__ import annotations

import math
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from robotteamsim.message_parts import RosMessage, header, robot_frame
from robotteamsim.scenario.base import SMALLEST
from robotteamsim.scenario.sensors.base import Carrier, Frame, Moment, MountedSensor, SensorName

_OPTICAL = (-0.5, 0.5, -0.5, 0.5)
"""The rotation of a frame with z forward, x to the right and y down (REP 103), as a quaternion x, y, z, w."""


class Camera(MountedSensor):
    """A camera, only in the world of MuJoCo; it shows floor, walls, doors, objects and robots, and no victims.

    Its reading: uint8, shape (height, width, 3), red, green, blue; of depth cameras float32, shape (height, width) [m].
    """

    type_name: ClassVar[str] = "sensor_msgs/Image"
    needs_mujoco: ClassVar[bool] = True

    name: SensorName = Field(
        description="a name, for topics robot_<id>/<name>/image and camera_info, frames robot_<id>/<name>_link and "
        "robot_<id>/<name>_optical_frame"
    )
    kind: Literal["camera"] = Field(default="camera", description="camera")
    images: Literal["rgb", "depth"] = Field(default="rgb", description="rgb: colours; depth: distances along its axis")
    width_px: int = Field(default=320, ge=16, le=4096, description="columns of an image")
    height_px: int = Field(default=240, ge=16, le=4096, description="rows of an image")
    fov_rad: float = Field(default=1.2, gt=0.05, le=2.8, description="horizontal angle of view [rad]")
    forward_m: float = Field(default=0.1, ge=-5.0, le=5.0, description="ahead of base_link [m]")
    height_m: float = Field(default=0.25, ge=SMALLEST, le=5.0, description="above base_link [m]")
    every_steps: int = Field(default=5, ge=1, le=10_000, description="an image every n-th step")

    @property
    def focal_px(self) -> float:
        """Focal length, the same for columns and rows."""
        return 0.5 * self.width_px / math.tan(0.5 * self.fov_rad)

    @property
    def topics(self) -> dict[str, str]:
        """See `Sensor`."""
        return {f"{self.name}/image": self.type_name, f"{self.name}/camera_info": "sensor_msgs/CameraInfo"}

    def frames(self) -> tuple[Frame, ...]:
        """See `Sensor`."""
        (link,) = super().frames()
        return link, Frame(self._optical_frame, link.name, (0.0, 0.0, 0.0), _OPTICAL)

    def is_due(self, moment: Moment) -> bool:
        """See `Sensor`."""
        return moment.step_index % self.every_steps == 0

    def measure(self, carrier: Carrier, generator: np.random.Generator) -> np.ndarray:
        """See `Sensor`."""
        return carrier.image(self)

    def messages(self, time_ns: int, robot_id: int, reading: np.ndarray, step_s: float = 0.0) -> dict[str, RosMessage]:
        """See `Sensor`."""
        image, info = self.topics
        return {
            image: self.message(time_ns, robot_id, reading),
            info: self._calibration(time_ns, robot_id),
        }

    def message(self, time_ns: int, robot_id: int, reading: np.ndarray) -> RosMessage:
        """See `Sensor`."""
        return {
            "header": self.header(time_ns, robot_id),
            "height": self.height_px,
            "width": self.width_px,
            "encoding": "rgb8" if self.images == "rgb" else "32FC1",
            "step": reading.nbytes // self.height_px,
            "data": np.frombuffer(reading.astype(reading.dtype.newbyteorder("<")).tobytes(), np.uint8),
        }

    def reading(self, message: Any) -> np.ndarray:
        """See `Sensor`."""
        shape = (self.height_px, self.width_px)
        expected = ("rgb8", "u1", (*shape, 3)) if self.images == "rgb" else ("32FC1", "<f4", shape)
        if (message.encoding, message.height, message.width) != (expected[0], *shape):
            text = f"{message.width} x {message.height} {message.encoding}"
            raise ValueError(f"image: {text}; expected {self.width_px} x {self.height_px} {expected[0]}")
        return np.frombuffer(bytes(message.data), expected[1]).reshape(expected[2])

    def _calibration(self, time_ns: int, robot_id: int) -> RosMessage:
        focal, x, y = self.focal_px, 0.5 * self.width_px, 0.5 * self.height_px
        return {
            "header": self.header(time_ns, robot_id),
            "height": self.height_px,
            "width": self.width_px,
            "distortion_model": "plumb_bob",
            "d": np.zeros(5),
            "k": np.array([focal, 0.0, x, 0.0, focal, y, 0.0, 0.0, 1.0]),
            "r": np.eye(3),
            "p": np.array([focal, 0.0, x, 0.0, 0.0, focal, y, 0.0, 0.0, 0.0, 1.0, 0.0]),
        }

    @property
    def _optical_frame(self) -> str:
        return f"{self.name}_optical_frame"

    def header(self, time_ns: int, robot_id: int) -> RosMessage:
        """Return the header of an image."""
        return header(time_ns, robot_frame(robot_id, self._optical_frame))
