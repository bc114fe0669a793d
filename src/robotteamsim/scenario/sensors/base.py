"""What all kinds of sensors have in common. Each kind is one file: its keys, its model, its topic and its message.

A kind that is added is one class below `Sensor`: here with a line in `scenario.sensors`, or in a user's own package
(docs/own_sensor.md).
"""

from __future__ import annotations

import contextlib
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Annotated, Any, ClassVar, Protocol

import numpy as np
from pydantic import AfterValidator, Field, SerializerFunctionWrapHandler, model_serializer

from robotteamsim.errors import RobotTeamSimError, SensorError
from robotteamsim.geometry import Pose
from robotteamsim.message_parts import RosMessage, header, robot_frame
from robotteamsim.scenario.base import Model, wrong
from robotteamsim.wording import described, place_of

_NAME = re.compile("[a-z][a-z0-9_]*")

_TAKEN = frozenset(
    (
        *("amcl_pose", "localisation", "map", "particlecloud"),
        *("base", "base_laser", "base_pose_ground_truth", "base_scan", "cmd_vel", "cmd_vel_stamped", "contact"),
        *("controller", "network", "odom", "radio_map", "teleop", "voice"),
    )
)
"""Topics and frames that every robot has."""


def is_free_name(name: str) -> bool:
    """Whether a sensor may have this name."""
    return _NAME.fullmatch(name) is not None and name not in _TAKEN


def _as_topic(name: str) -> str:
    if not _NAME.fullmatch(name):
        raise wrong("", f"'{name}' cannot be a topic; expected a lower-case letter, then letters, digits and _")
    if name in _TAKEN:
        raise wrong("", f"'{name}' is reserved for the robot itself")
    return name


SensorName = Annotated[str, AfterValidator(_as_topic)]
"""The name of a sensor: its topic is robot_<id>/<name>, its frame robot_<id>/<name>_link."""


@dataclass(frozen=True)
class Frame:
    """A frame of a sensor: where its origin lies in its parent [m], and its rotation as a quaternion x, y, z, w."""

    name: str
    parent: str
    position_m: tuple[float, float, float]
    rotation: tuple[float, float, float, float]


class Air(Protocol):
    """Fire and smoke around a robot."""

    def temperature_c(self) -> float:
        """Return the temperature at the robot [degC]."""

    def hot_places(self, range_m: float) -> tuple[tuple[tuple[float, float], ...], tuple[float, ...]]:
        """Return the hot places that no wall and no closed door hides within a range: their centres in `map` [m], and
        their temperatures [degC].
        """


@dataclass(frozen=True, slots=True)
class Fan:
    """Beams with equal angles between them, from one point of a robot, parallel to its floor.

    angle_min_rad, angle_max_rad: of the first and of the last beam in base_link.
    forward_m, left_m, height_m:  their origin in base_link.
    range_max_m:                  where they end.
    """

    beams: int
    angle_min_rad: float
    angle_max_rad: float
    forward_m: float
    left_m: float
    height_m: float
    range_max_m: float


@dataclass(frozen=True, slots=True)
class BeamModel:
    """The beams of a sensor, and what it reports for ranges below range_min_m and above the end of the beams."""

    fan: Fan
    range_min_m: float
    too_near_m: float
    no_return_m: float


class Carrier(Protocol):
    """What a sensor measures from: the robot that carries it, after the last step of the world."""

    @property
    def robot_id(self) -> int:
        """The id of the robot."""

    @property
    def world(self) -> Any:
        """The world, a `world.contract.AnyWorld`: its plan, all robots, doors and objects. A sensor changes nothing."""

    @property
    def pose(self) -> Pose:
        """The true pose in `map`."""

    @property
    def air(self) -> Air:
        """Fire and smoke, for sensors with `needs_fire`."""

    def ranges_m(self, beams: BeamModel, noise_m: np.ndarray) -> np.ndarray:
        """Return the ranges that beams of light report, in smoke as well, float32, shape (beams,) [m].

        Args: noise_m: added to the ranges, shape (beams,); empty: none.
        """

    def nearest_m(self, beams: BeamModel, noise_m: np.ndarray) -> float:
        """Return the shortest range of beams that smoke does not stop, as it is reported [m].

        Args: noise_m: added to it, shape (1,); empty: none.
        """

    def illuminance_lx(self, sensor: Any) -> float:
        """Return the light of the scenario's lights on a light sensor [lx]."""

    def image(self, sensor: Any) -> np.ndarray:
        """Return what a camera sees: uint8, shape (height, width, 3), or depths, float32, shape (height, width) [m].

        Raises: CameraError: nothing can be drawn on this computer.
        """


@dataclass(frozen=True)
class Moment:
    """A step, as far as it decides which sensors measure in it.

    fire_advances: whether fire and smoke advance in this step.
    """

    sim_time_ns: int
    step_ns: int
    fire_advances: bool = False

    @property
    def step_index(self) -> int:
        """1 in the first step."""
        return self.sim_time_ns // self.step_ns


class Sensor(Model):
    """A sensor that a robot carries besides its laser `base_scan`; its readings are on a topic of their own."""

    name: SensorName = Field(description="a name, for topic robot_<id>/<name> and frame robot_<id>/<name>_link")
    kind: str

    type_name: ClassVar[str]
    """The type of its message, such as "sensor_msgs/Range"."""
    definitions: ClassVar[Mapping[str, str]] = MappingProxyType({})
    """Types of messages that no version of ROS has, in the language of .msg files, for bags and MCAP files."""
    needs_mujoco: ClassVar[bool] = False
    """Whether only the world of MuJoCo has what it measures."""
    needs_fire: ClassVar[bool] = False
    """Whether it measures only in scenarios with a fire."""

    @model_serializer(mode="wrap")
    def _with_kind(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Keep the kind where defaults are left out."""
        return {"kind": self.kind, **handler(self)}

    def is_due(self, moment: Moment) -> bool:
        """Return whether it measures in a step."""
        return True

    def measure(self, carrier: Carrier, generator: np.random.Generator) -> Any:
        """Return the reading of a step. Args: generator: of its noise."""
        raise NotImplementedError

    def message(self, time_ns: int, robot_id: int, reading: Any) -> RosMessage:
        """Return the message of a reading."""
        raise NotImplementedError

    def reading(self, message: Any) -> Any:
        """Return the reading of a message; the inverse of `message`. Raises: ValueError: numbers out of range."""
        raise NotImplementedError

    def text(self, reading: Any) -> str:
        """Return a reading in a few words, for the panel of the viewer; "" is not shown, as by default."""
        return ""

    def frames(self) -> tuple[Frame, ...]:
        """Return its frames; without any it measures at base_link."""
        return ()

    @property
    def topics(self) -> dict[str, str]:
        """Names of its topics in the robot's namespace, and their types; `messages` has the same keys."""
        return {self.name: self.type_name}

    def messages(self, time_ns: int, robot_id: int, reading: Any, step_s: float = 0.0) -> dict[str, RosMessage]:
        """Return its messages by the names of `topics`. Args: step_s: length of a step [s]; 0: unknown."""
        return {self.name: self.message(time_ns, robot_id, reading)}


@contextlib.contextmanager
def naming(sensor: Sensor, robot_id: int) -> Iterator[None]:
    """Let an error in a sensor's methods name it. Raises: SensorError."""
    try:
        yield
    except (RobotTeamSimError, KeyboardInterrupt):
        raise
    except BaseException as error:  # of a user's class, also SystemExit
        _, place = place_of(error)
        what = f"robot {robot_id}, sensor {sensor.name} (kind {sensor.kind})"
        raise SensorError(f"{what}: {described(error)} ({place})") from error


def reading_of(sensor: Sensor, robot_id: int, message: Any) -> Any:
    """Return the reading of a message. Raises: ValueError: as `Sensor.reading`. SensorError: any other error of it."""
    try:
        return sensor.reading(message)
    except ValueError:
        raise
    except BaseException:
        with naming(sensor, robot_id):
            raise


def text_of(sensor: Sensor, robot_id: int, reading: Any) -> str:
    """Return a reading in words. Raises: SensorError: as `naming`."""
    with naming(sensor, robot_id):
        text = sensor.text(reading)
        if not isinstance(text, str):
            raise TypeError(f"text returns {text!r:.40}; expected a str")
    return text


def messages_of(
    sensor: Sensor, time_ns: int, robot_id: int, reading: Any, step_s: float = 0.0
) -> dict[str, RosMessage]:
    """Return the messages of a reading, by topic. Raises: SensorError: those of other topics; as `naming`."""
    with naming(sensor, robot_id):
        messages = sensor.messages(time_ns, robot_id, reading, step_s)
        if messages.keys() != sensor.topics.keys():
            raise ValueError(f"messages of {', '.join(messages)}; expected those of {', '.join(sensor.topics)}")
        for message in messages.values():
            if not isinstance(message, dict):
                raise TypeError(f"a message is {message!r:.40}; expected a dict")
    return messages


class MountedSensor(Sensor):
    """A sensor with a pose on the robot and a frame of its own; its x axis points to yaw_rad."""

    forward_m: float = Field(default=0.0, ge=-5.0, le=5.0, description="ahead of base_link [m]")
    left_m: float = Field(default=0.0, ge=-5.0, le=5.0, description="left of base_link [m]")
    height_m: float = Field(default=0.25, ge=0.0, le=5.0, description="above base_link [m]")
    yaw_rad: float = Field(default=0.0, ge=-6.2832, le=6.2832, description="direction of its x axis in base_link [rad]")

    def frames(self) -> tuple[Frame, ...]:
        """Return its frame, <name>_link."""
        half_rad = 0.5 * math.remainder(self.yaw_rad, math.tau)
        return (self._link((0.0, 0.0, math.sin(half_rad), math.cos(half_rad))),)

    def _link(self, rotation: tuple[float, float, float, float]) -> Frame:
        return Frame(f"{self.name}_link", "base_link", (self.forward_m, self.left_m, self.height_m), rotation)

    def header(self, time_ns: int, robot_id: int) -> RosMessage:
        """Return the header of a message in its frame."""
        return header(time_ns, robot_frame(robot_id, f"{self.name}_link"))


def expect_within(name: str, value: float, low: float, high: float) -> float:
    """Return a number of a message. Raises: ValueError: it is not within the limits, or NaN."""
    if not low <= value <= high:
        raise ValueError(f"{name}: {value:g}; expected {low:g} to {high:g}")
    return float(value)
