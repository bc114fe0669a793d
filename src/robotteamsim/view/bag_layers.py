"""What a viewer shows of a bag besides its run: signals, doors, voice maps, fire, smoke, lasers."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from robotteamsim.errors import RecordingError
from robotteamsim.propagation import FieldMap
from robotteamsim.recording.bag_reader import BagReader
from robotteamsim.recording.hazard_messages import FIRE_GRID, SMOKE_GRID, TEMPERATURE
from robotteamsim.scenario.plan import OccupancyGrid
from robotteamsim.view.frame import Link, enclosed_of, links_of

_NETWORK, _DOORS, _PEOPLE, _VOICE = "/network/state", "/world/doors", "/world/people", "/voice_map/values"
_TEAM_TYPES = {
    _NETWORK: "robotteamsim/NetworkState",
    _DOORS: "robotteamsim/Doors",
    _PEOPLE: "robotteamsim/People",
    _VOICE: "robotteamsim/FloatMap",
    FIRE_GRID: "nav_msgs/OccupancyGrid",
    SMOKE_GRID: "nav_msgs/OccupancyGrid",
    TEMPERATURE: "robotteamsim/FloatMap",
}
_SCAN_TYPE = "sensor_msgs/LaserScan"

_MOST_DB, _MOST_M, _MOST_RAD, _MOST_C = 1e3, 1e6, 1e2, 1e4
"""Larger numbers are not measurements, but damage."""


class Scan(NamedTuple):
    """One scan of a laser. ranges_m: from 0 to range_max_m, which also stands for beams without return."""

    ranges_m: list[float]
    angle_min_rad: float
    angle_step_rad: float
    range_max_m: float


class BagLayers:
    """Values by topic, each in the order of its stamps [ns]."""

    def __init__(self, samples: Mapping[str, Sequence[tuple[int, Any]]]) -> None:
        self._samples = {topic: sorted(some, key=lambda sample: sample[0]) for topic, some in samples.items()}
        self._stamps = {topic: [stamp_ns for stamp_ns, _ in some] for topic, some in self._samples.items()}

    def links(self, stamp_ns: int) -> tuple[Link, ...] | None:
        """Return the links with their signals; None: the bag does not contain them."""
        found: tuple[Link, ...] | None = self._last(_NETWORK, stamp_ns)
        return found

    def doors(self, stamp_ns: int) -> Mapping[str, float]:
        """Return the opening of each door by its name."""
        return self._last(_DOORS, stamp_ns) or {}

    def enclosed(self, stamp_ns: int) -> frozenset[str]:
        """Return the names of the people for whom no path to an exit is open."""
        found: frozenset[str] = self._last(_PEOPLE, stamp_ns) or frozenset()
        return found

    def scan(self, robot: str, stamp_ns: int) -> Scan | None:
        """Return the last scan of a robot. Args: robot: its name in the run."""
        found: Scan | None = self._last(scan_topic(robot), stamp_ns)
        return found

    def first_scan(self, robot: str) -> Scan | None:
        """Return the first scan of a robot; None: the bag has none."""
        found: Sequence[tuple[int, Scan]] = self._samples.get(scan_topic(robot), ())
        return found[0][1] if found else None

    def voice_maps(self) -> Sequence[tuple[int, FieldMap]]:
        """Return all voice maps with their stamps [ns]."""
        return self._samples.get(_VOICE, ())

    def maps(self, topic: str) -> Sequence[tuple[int, Any]]:
        """Return all maps of a topic of fire or smoke, with their stamps [ns]."""
        return self._samples.get(topic, ())

    def _last(self, topic: str, stamp_ns: int) -> Any | None:
        if topic not in self._samples:
            return None
        index = bisect_right(self._stamps[topic], stamp_ns) - 1
        return self._samples[topic][index][1] if index >= 0 else None


def scan_topic(robot: str) -> str:
    """Return the topic of a robot's laser; the robot of a bag without namespaces is named "robot"."""
    return "/base_scan" if robot == "robot" else f"/{robot}/base_scan"


def read_layers(paths: Sequence[Path], scanned: Sequence[str]) -> BagLayers:
    """Read the layers of a bag, or of the parts of one.

    Args:   scanned: names of the robots whose scans are read.
    Raises: RecordingError: a bag cannot be read, or contains impossible values.
    """
    samples: dict[str, list[tuple[int, Any]]] = {}
    with BagReader(paths) as bag:
        wanted = _TEAM_TYPES | dict.fromkeys(map(scan_topic, scanned), _SCAN_TYPE)
        types = {topic: kind for topic, kind in wanted.items() if bag.topics.get(topic) == kind and bag.is_known(topic)}
        unread: set[str] = set()
        for topic, stamp_ns, message in bag.messages(set(types)):
            try:
                samples.setdefault(topic, []).append((stamp_ns, _converter(topic, types[topic])(message)))
            except AttributeError:  # This version of the type lacks an attribute.
                unread.add(topic)
            except ValueError as error:
                raise RecordingError(f"{', '.join(map(str, paths))}: {topic}: {error}") from None
    return BagLayers({topic: some for topic, some in samples.items() if topic not in unread})


def _links(message: Any) -> tuple[Link, ...]:
    n = message.num_robots
    if not n * n == len(message.adjacency) == len(message.rssi_dbm):
        raise ValueError(f"matrices of {len(message.adjacency)} values; expected {n * n}")
    adjacency = message.adjacency.reshape(n, n).astype(bool)
    return links_of(adjacency, _finite(message.rssi_dbm, "signals", _MOST_DB).reshape(n, n))


def _doors(message: Any) -> dict[str, float]:
    return {door.name: min(max(door.opening, 0.0), 1.0) for door in message.doors if math.isfinite(door.opening)}


def _enclosed(message: Any) -> frozenset[str]:
    return enclosed_of(message.people)


def _voice_map(message: Any) -> FieldMap:
    return _field_map(message, "levels", _MOST_DB)


def _temperatures(message: Any) -> FieldMap:
    return _field_map(message, "temperatures", _MOST_C)


def _field_map(message: Any, name: str, most: float) -> FieldMap:
    if not 0 < message.width * message.height == len(message.data):
        raise ValueError(f"map of {len(message.data)} values; expected {message.width * message.height}")
    _finite([message.resolution_m, message.origin.x, message.origin.y], "resolution and origin", _MOST_M)
    if message.resolution_m <= 0.0:
        raise ValueError(f"resolution {message.resolution_m:g} m; expected more than 0")
    values = _finite(message.data, name, most).astype(np.float32).reshape(message.height, message.width)
    return FieldMap((message.origin.x, message.origin.y), message.resolution_m, values)


def _grid(message: Any) -> OccupancyGrid:
    info, origin = message.info, message.info.origin.position
    if not 0 < info.width * info.height == len(message.data):
        raise ValueError(f"grid of {len(message.data)} cells; expected {info.width * info.height}")
    _finite([info.resolution, origin.x, origin.y], "resolution and origin", _MOST_M)
    if not info.resolution > 0.0:
        raise ValueError(f"resolution {info.resolution:g} m; expected more than 0")
    cells = np.asarray(message.data, dtype=np.int8).reshape(info.height, info.width)
    return OccupancyGrid((origin.x, origin.y), float(info.resolution), cells)


def _scan(message: Any) -> Scan:
    highest_m = float(message.range_max)
    if not 0.0 <= highest_m <= _MOST_M:
        raise ValueError(f"range_max {highest_m:g} m; expected 0 to {_MOST_M:g}")
    _finite([message.angle_min, message.angle_increment], "angles", _MOST_RAD)
    ranges_m = np.nan_to_num(np.asarray(message.ranges, dtype=np.float64), nan=highest_m, posinf=highest_m, neginf=0.0)
    angles_rad = float(message.angle_min), float(message.angle_increment)
    return Scan(np.clip(ranges_m, 0.0, highest_m).tolist(), *angles_rad, highest_m)


def _finite(values: Any, name: str, most: float) -> np.ndarray:
    """Return numbers, with 0 for those that are not finite. Raises: ValueError: one is impossibly large."""
    numbers: np.ndarray = np.nan_to_num(np.asarray(values, dtype=np.float64), posinf=0.0, neginf=0.0)
    if numbers.size and np.abs(numbers).max() > most:
        raise ValueError(f"{name} up to {np.abs(numbers).max():g}; expected at most {most:g}")
    return numbers


_CONVERTERS: dict[str, Callable[[Any], Any]] = {
    "robotteamsim/NetworkState": _links,
    "robotteamsim/Doors": _doors,
    "robotteamsim/People": _enclosed,
    "robotteamsim/FloatMap": _voice_map,
    "nav_msgs/OccupancyGrid": _grid,
    _SCAN_TYPE: _scan,
}


def _converter(topic: str, kind: str) -> Callable[[Any], Any]:
    return _temperatures if topic == TEMPERATURE else _CONVERTERS[kind]
