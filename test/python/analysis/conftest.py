"""Bags to analyse: of a short run in which much happens, and made by hand."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from rosbags.interfaces import Connection
from rosbags.rosbag1 import Writer

from robotteamsim.geometry import Pose, PoseReading, Twist
from robotteamsim.mission.events import Event
from robotteamsim.recording import BagWriter
from robotteamsim.recording.bag_types import bag_typestore, message_type
from robotteamsim.recording.results import EventList
from robotteamsim.recording.topics import robots
from robotteamsim.scenario import load
from robotteamsim.sensing.readings import OdometryReading
from robotteamsim.simulation import Result, Simulation

Sample = tuple[str, str, int, Any]
"""Topic, type, time of recording [ns], message."""


@dataclass(frozen=True)
class Recorded:
    """A bag, and what the run itself said."""

    bag: Path
    result: Result
    events: list[Event]


@pytest.fixture(scope="session")
def busy(tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    """Five robots with weak radios walk at random for 25 s: links break, walls are touched."""
    path, events = tmp_path_factory.mktemp("busy") / "busy.bag", EventList()
    weak = ["robots.count=5", "control.algorithm=random_walk", "radio.tx_power_dbm=-30"]
    result = Simulation(load("garage_sar", [*weak, "voice.noise_db=5", "mission.time_limit_s=25"])).run(
        [BagWriter(path), events]
    )
    return Recorded(path, result, events.events)


@pytest.fixture(scope="session")
def adapted(tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    """Two robots that adapt their coefficients drive for 20 s."""
    path, events = tmp_path_factory.mktemp("adapted") / "adapted.bag", EventList()
    settings = ["robots.count=2", "control.adaptation=fuzzy", "mission.time_limit_s=20"]
    result = Simulation(load("garage_sar", settings)).run([BagWriter(path), events])
    return Recorded(path, result, events.events)


@pytest.fixture(scope="session")
def comes_again(tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    """Of four robots one leaves after 5 s and comes elsewhere after 8 s; the last one is not there for 10 s; 12 s."""
    path, events = tmp_path_factory.mktemp("comes") / "comes.bag", EventList()
    schedule = "schedule=[{at_s: 5, remove: 1}, {at_s: 8, spawn: 1, pose: [20, 5, 0]}, {at_s: 10, spawn: 3}]"
    settings = ["robots.count=4", "robots.reserve=1", schedule, "mission.time_limit_s=12"]
    result = Simulation(load("garage_sar", settings)).run([BagWriter(path), events])
    return Recorded(path, result, events.events)


@pytest.fixture(scope="session")
def write_bag() -> Callable[..., Path]:
    """Write samples into a bag, of messages to be sent or of those that were read; `compression` is "bz2" or "lz4"."""

    def as_sent(read: Any) -> Any:
        if isinstance(read, list):
            return [as_sent(one) for one in read]
        return {key: as_sent(one) for key, one in vars(read).items()} if isinstance(read, SimpleNamespace) else read

    def write(path: Path, samples: Iterable[Sample], compression: str | None = None) -> Path:
        connections: dict[str, Connection] = {}
        bag = Writer(path)
        if compression:
            bag.set_compression(Writer.CompressionFormat[compression.upper()])
        with bag:
            for topic, kind, time_ns, message in samples:
                name = kind.replace("/", "/msg/")
                if topic not in connections:
                    connections[topic] = bag.add_connection(topic, name, typestore=bag_typestore())
                bag.write(connections[topic], time_ns, message_type(kind).encode(as_sent(message)))
        return path

    return write


@pytest.fixture(scope="session")
def odometry() -> Callable[..., Any]:
    """Make a nav_msgs/Odometry; `frame` replaces that of robot 0."""

    def message(time_ns: int, x_m: float, y_m: float, yaw_rad: float = 0.0, frame: str = "robot_0/odom") -> Any:
        reading = OdometryReading(PoseReading.from_pose(Pose(x_m, y_m, yaw_rad)), Twist())
        built = robots.odometry(time_ns, 0, reading)
        built["header"]["frame_id"] = frame
        return built

    return message


@pytest.fixture(scope="session")
def placed_at() -> Callable[..., Any]:
    """Make a tf2_msgs/TFMessage that places robot 0's odometry in map."""

    def message(time_ns: int, x_m: float, y_m: float, yaw_rad: float) -> Any:
        place = robots.localization(time_ns, 0, PoseReading.from_pose(Pose(x_m, y_m, yaw_rad)))
        return {"transforms": [place]}

    return message
