"""What a row of the table of topics contains, and the parts and checks that messages share.

A row describes one topic for all its users: bags and MCAP files, the nodes, readers of messages, and the test of the
tables in docs/ros_api.md. Rows and the functions that make and read their messages are side by side, by subject.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

import numpy as np

from robotteamsim.geometry import PoseReading, Twist
from robotteamsim.message_parts import MAP_FRAME, RosMessage, header, point
from robotteamsim.network.compact import LinksEncoder
from robotteamsim.propagation import FieldMap
from robotteamsim.scenario import Scenario
from robotteamsim.scenario.objects import MovableObject
from robotteamsim.scenario.plan import OccupancyGrid
from robotteamsim.setup import Setup

FARTHEST_M = 1e6
"""Limit of coordinates, as in the propagation models."""
LARGEST_VALUE = 1e4
"""Limit of the values of maps, in dB or degrees Celsius; larger ones are damage."""
LONGEST_S = 1e9
"""Limit of times [s]."""


class When(Enum):
    """When a topic has a message, as docs/ros_api.md says it."""

    STEP = "per step"
    CHANGE = "on change"
    EVENT = "when something happens"
    FIRE = "when fire and smoke advance"
    ONCE = "once"
    CLOCK = "50 times per simulated second"
    SHOWN = "every 5 s"
    CLOUD = "once a second if"
    REQUEST = "once a second, to subscribers"


class KnownObjects:
    """Remembers the objects of the last message."""

    def __init__(self) -> None:
        """Start without a message."""
        self._models: tuple[MovableObject, ...] | None = None

    def replace(self, models: tuple[MovableObject, ...]) -> bool:
        """Remember objects; return whether they are others than those of the last message."""
        is_new, self._models = models != self._models, models
        return is_new


@dataclass(frozen=True, slots=True)
class Source:
    """What values are taken from, next to a step.

    links:   remembers the links of the last /network/links.
    objects: remembers which objects were in the last /world/objects.
    localized: whether /tf has map -> odom of each robot without error; of robots that localise themselves it has what
               they believe.
    """

    setup: Setup
    links: LinksEncoder = field(default_factory=LinksEncoder)
    objects: KnownObjects = field(default_factory=KnownObjects)
    localized: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Topic:
    """A topic of the team, or one below /robot_<id>/.

    values:   of (source, step) or, for each robot, of (source, step, robot_id), in the form of the arguments of
              `message`; None if the step has no message. A step is a `StepRecord`, or a part of one.
    message:  makes the `RosMessage` of (time [ns], *values).
    latched:  whether later subscribers get the last message.
    version:  of a step's contents, for a latched topic that rarely changes: bags have a message per change.
    several:  whether the values are those of several messages.
    is_in:    whether a scenario has the topic.   in_bags: whether bags have it, too.
    read:     returns the value of (message, setup, robot_id), for nodes and for readers of bags, which may know neither
              setup nor robot (None). Raises: ValueError: an impossible one. AttributeError: a type of another version.
    """

    name: str
    type_name: str
    when: When
    values: Callable[..., Sequence[Any] | None]
    message: Callable[..., Any]
    latched: bool = False
    version: Callable[[Any], Any] | None = None
    several: bool = False
    is_in: Callable[[Scenario], bool] = lambda _: True
    in_bags: bool = True
    read: Callable[..., Any] | None = None

    def messages(self, time_ns: int, values: Sequence[Any] | None) -> list[Any]:
        """Return the messages of a step's values."""
        if values is None:
            return []
        return [self.message(time_ns, *one) for one in (values if self.several else (values,))]


class Changes:
    """Remembers the version of what each topic has shown."""

    def __init__(self) -> None:
        """Start without any."""
        self._shown: dict[str, Any] = {}

    def note(self, topic: Topic, step: Any) -> bool:
        """Return whether a topic's contents have changed; a topic without versions always has."""
        if topic.version is None:
            return True
        version = topic.version(step)
        if topic.name in self._shown and self._shown[topic.name] == version:
            return False
        self._shown[topic.name] = version
        return True


def pose(reading: PoseReading) -> RosMessage:
    """geometry_msgs/Pose."""
    return {"position": {"x": reading.x_m, "y": reading.y_m}, "orientation": quaternion(reading)}


def quaternion(reading: PoseReading) -> RosMessage:
    """geometry_msgs/Quaternion."""
    return {"z": reading.qz, "w": reading.qw}


def twist(command: Twist) -> RosMessage:
    """geometry_msgs/Twist."""
    return {
        "linear": {"x": command.linear_x_mps, "y": command.linear_y_mps},
        "angular": {"z": command.angular_z_radps},
    }


def occupancy_grid(time_ns: int, grid: OccupancyGrid, frame: str = MAP_FRAME) -> RosMessage:
    """nav_msgs/OccupancyGrid. Args: frame: that of the grid's origin."""
    rows, columns = grid.cells.shape
    origin = PoseReading(float(grid.origin_m[0]), float(grid.origin_m[1]), 0.0, 1.0)
    return {
        "header": header(time_ns, frame),
        "info": {
            "map_load_time": time_ns,
            "resolution": grid.resolution_m,
            "width": columns,
            "height": rows,
            "origin": pose(origin),
        },
        "data": np.asarray(grid.cells, dtype=np.int8),
    }


def field_map_picture(time_ns: int, field: FieldMap) -> RosMessage:
    """nav_msgs/OccupancyGrid of a map of levels, or of a belief in per cent, for rviz: integers from 0 to 100."""
    levels = np.clip(np.round(field.values), 0, 100).astype(np.int8)
    return occupancy_grid(time_ns, OccupancyGrid(field.origin_m, field.resolution_m, levels))


def field_map(time_ns: int, field: FieldMap, quantity: str, unit: str) -> RosMessage:
    """robotteamsim/FloatMap, such as quantity "voice_level" in unit "dB"."""
    rows, columns = field.values.shape
    return {
        "header": header(time_ns, MAP_FRAME),
        "quantity": quantity,
        "unit": unit,
        "resolution_m": field.resolution_m,
        "width": columns,
        "height": rows,
        "origin": point(field.origin_m),
        "data": np.asarray(field.values, dtype=np.float32),
    }


def read_occupancy_grid(message: Any) -> OccupancyGrid:
    """Return a grid. Raises: ValueError: it is rotated, incomplete, or at an impossible place."""
    info, origin = message.info, message.info.origin
    if not abs(origin.orientation.z) <= 1e-6:
        raise ValueError("a rotated grid; expected the axes of map")
    cells = _cells("grid of {} cells", info, message.data, info.resolution, origin.position)
    return OccupancyGrid((origin.position.x, origin.position.y), float(info.resolution), np.asarray(cells, np.int8))


def read_field_map(message: Any) -> FieldMap:
    """Return a map of a quantity, float32; NaN is unknown. Raises: ValueError: as `read_occupancy_grid`, or a value."""
    cell_m, origin = message.resolution_m, message.origin
    values = np.asarray(_cells("map of {} values", message, message.data, cell_m, origin), np.float32)
    largest = float(np.abs(values).max(initial=0.0, where=np.isfinite(values)))
    if largest > LARGEST_VALUE:
        raise ValueError(f"values up to {largest:g}; expected at most {LARGEST_VALUE:g}")
    return FieldMap((origin.x, origin.y), float(cell_m), values)


def _cells(what: str, size: Any, data: Any, cell_m: float, origin: Any) -> np.ndarray:
    """Return data in rows. Raises: ValueError: as `read_occupancy_grid`. Args: what: is placed, for the error."""
    if not 0 < size.width * size.height == len(data):
        raise ValueError(f"{what.format(len(data))}; expected {size.width * size.height}")
    check_within("resolution", cell_m, FARTHEST_M)
    if not cell_m > 0.0:
        raise ValueError(f"resolution {cell_m:g}; expected more than 0")
    check_place("origin", origin.x, origin.y)
    return np.reshape(data, (size.height, size.width))


def read_twist(message: Any) -> Twist:
    """Return a command in the plane. Raises: ValueError: it is not finite."""
    command = Twist(message.linear.x, message.linear.y, message.angular.z)
    if not command.is_finite:
        raise ValueError("a command that is not finite")
    return command


def read_point(name: str, message: Any) -> tuple[float, float]:
    """Return a place on the floor [m]. Raises: ValueError: see `check_place`."""
    check_place(name, message.x, message.y)
    return message.x, message.y


def check_place(name: str, *coordinates: float) -> None:
    """Raises: ValueError: a coordinate [m] is not finite or beyond 1000 km."""
    for coordinate in coordinates:
        if not abs(coordinate) <= FARTHEST_M:
            shown = ", ".join(f"{value:g}" for value in coordinates)
            raise ValueError(f"{name}: ({shown}); expected finite numbers within 1000 km")


def check_within(name: str, value: float, most: float) -> float:
    """Return a number. Raises: ValueError: it is not finite, or impossibly large."""
    if not abs(value) <= most:
        raise ValueError(f"{name} {value:g}; expected at most {most:g}")
    return float(value)


def check_finite(name: str, *values: float) -> None:
    """Raises: ValueError: a number is not finite."""
    for value in values:
        if not math.isfinite(value):
            raise ValueError(f"{name}: {value:g}; expected finite numbers")
