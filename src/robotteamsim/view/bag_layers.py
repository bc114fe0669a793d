"""What a viewer shows of a bag besides its run: signals, doors, voice maps, fire, smoke, lasers."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np

from robotteamsim.analysis.runs.recorded_run import RecordedRobot
from robotteamsim.errors import RecordingError
from robotteamsim.propagation import FieldMap
from robotteamsim.recording.bag_reader import BagReader
from robotteamsim.recording.topics import Topic
from robotteamsim.recording.topics.mission import EGRESS, read_egress
from robotteamsim.recording.topics.radio import NETWORK_STATE, VOICE_MAP
from robotteamsim.recording.topics.robots import SCAN
from robotteamsim.recording.topics.world import DOORS, FIRE, OBJECTS, PEOPLE, SMOKE, TEMPERATURE, read_objects
from robotteamsim.scenario.plan import OccupancyGrid
from robotteamsim.view.frame import Link, enclosed_of, finite_ranges, links_of

_MOST_DB, _MOST_M, _MOST_RAD, _MOST_C = 1e3, 1e6, 1e2, 1e4
"""Larger numbers are not measurements, but damage."""

Value = TypeVar("Value")
Default = TypeVar("Default")


class Timeline(Generic[Value]):
    """Values with their stamps [ns], in the order of the stamps."""

    def __init__(self, samples: Iterable[tuple[int, Value]]) -> None:
        self.samples = sorted(samples, key=lambda sample: sample[0])

    def at(self, stamp_ns: int, before: Default) -> Value | Default:
        """Return the last value up to a stamp. Args: before: returned if there is none yet."""
        index = bisect_right(self.samples, stamp_ns, key=lambda sample: sample[0])
        return self.samples[index - 1][1] if index else before


class Scan(NamedTuple):
    """One scan of a laser. ranges_m: from 0 to range_max_m, which also stands for beams without return."""

    ranges_m: list[float]
    angle_min_rad: float
    angle_step_rad: float
    range_max_m: float


BagLayers = Mapping[Topic, Timeline[Any]]
"""Values over time, in the form of `_OF_TEAM`, by topic; one that the bag lacks has none."""


def read_layers(
    paths: Sequence[Path], scanned: Sequence[RecordedRobot], shown_ns: Sequence[int]
) -> tuple[BagLayers, dict[str, Timeline[Scan]]]:
    """Read the layers of a bag, or of the parts of one, and the scans of robots by their names in the run.

    Args:   scanned: the robots whose scans are read.  shown_ns: stamps at which scans are shown, in order; only the
            last ones up to each are kept.
    Raises: RecordingError: a bag cannot be read, or contains impossible values.
    """
    scan_topics = {f"{robot.namespace}/base_scan": robot.name for robot in scanned}
    types = {topic.name: topic.type_name for topic in _OF_TEAM} | dict.fromkeys(scan_topics, SCAN.type_name)
    converters = {topic.name: convert for topic, convert in _OF_TEAM.items()}
    samples: dict[str, list[tuple[int, Any]]] = {topic: [] for topic in types}
    shown: dict[tuple[str, int], tuple[int, Any]] = {}
    unread: set[str] = set()

    def keep(topic: str, stamp_ns: int, message: Any, convert: Callable[[Any], Any]) -> None:
        try:
            samples[topic].append((stamp_ns, convert(message)))
        except AttributeError:  # This version of the type lacks an attribute.
            unread.add(topic)
        except ValueError as error:
            raise RecordingError(f"{', '.join(map(str, paths))}: {topic}: {error}") from None

    with BagReader(paths) as bag:
        known = {topic for topic, kind in types.items() if bag.topics.get(topic) == kind and bag.is_known(topic)}
        for topic, stamp_ns, message in bag.messages(known):
            if topic in converters:
                keep(topic, stamp_ns, message, converters[topic])
            elif (key := (topic, bisect_left(shown_ns, stamp_ns))) not in shown or shown[key][0] <= stamp_ns:
                shown[key] = stamp_ns, message
    for (topic, _), (stamp_ns, message) in shown.items():
        keep(topic, stamp_ns, message, _scan)
    lines = {topic: Timeline(() if topic in unread else some) for topic, some in samples.items()}
    of_team = {topic: lines[topic.name] for topic in _OF_TEAM}
    return of_team, {name: lines[topic] for topic, name in scan_topics.items()}


def _links(message: Any) -> tuple[Link, ...]:
    n = message.num_robots
    if not n * n == len(message.adjacency) == len(message.rssi_dbm):
        raise ValueError(f"matrices of {len(message.adjacency)} values; expected {n * n}")
    adjacency = message.adjacency.reshape(n, n).astype(bool)
    return links_of(adjacency, _finite(message.rssi_dbm, "signals", _MOST_DB).reshape(n, n))


def _openings(message: Any) -> dict[str, float]:
    """Return how far doors are open, by their names."""
    return {door.name: min(max(door.opening, 0.0), 1.0) for door in message.doors if math.isfinite(door.opening)}


def _field_map(message: Any, name: str, most: float) -> FieldMap:
    _check_cells("map of {} values", message, message.data, message.resolution_m, message.origin)
    values = _finite(message.data, name, most).astype(np.float32).reshape(message.height, message.width)
    return FieldMap((message.origin.x, message.origin.y), message.resolution_m, values)


def _grid(message: Any) -> OccupancyGrid:
    info, origin = message.info, message.info.origin.position
    _check_cells("grid of {} cells", info, message.data, info.resolution, origin)
    cells = np.asarray(message.data, dtype=np.int8).reshape(info.height, info.width)
    return OccupancyGrid((origin.x, origin.y), float(info.resolution), cells)


def _check_cells(what: str, size: Any, data: Sequence[Any], cell_m: float, origin: Any) -> None:
    """Raises: ValueError: numbers of cells that differ, or an impossible place."""
    if not 0 < size.width * size.height == len(data):
        raise ValueError(f"{what.format(len(data))}; expected {size.width * size.height}")
    _finite([cell_m, origin.x, origin.y], "resolution and origin", _MOST_M)
    if not cell_m > 0.0:
        raise ValueError(f"resolution {cell_m:g} m; expected more than 0")


def _scan(message: Any) -> Scan:
    highest_m = float(message.range_max)
    if not 0.0 <= highest_m <= _MOST_M:
        raise ValueError(f"range_max {highest_m:g} m; expected 0 to {_MOST_M:g}")
    _finite([message.angle_min, message.angle_increment], "angles", _MOST_RAD)
    ranges_m = finite_ranges(np.clip(message.ranges, 0.0, highest_m), highest_m)
    return Scan(ranges_m, float(message.angle_min), float(message.angle_increment), highest_m)


def _finite(values: Any, name: str, most: float) -> np.ndarray:
    """Return numbers, with 0 for those that are not finite. Raises: ValueError: one is impossibly large."""
    numbers: np.ndarray = np.nan_to_num(np.asarray(values, dtype=np.float64), posinf=0.0, neginf=0.0)
    if numbers.size and np.abs(numbers).max() > most:
        raise ValueError(f"{name} up to {np.abs(numbers).max():g}; expected at most {most:g}")
    return numbers


_OF_TEAM: dict[Topic, Callable[[Any], Any]] = {
    NETWORK_STATE: _links,
    DOORS: _openings,
    OBJECTS: read_objects,
    PEOPLE: lambda message: enclosed_of(message.people),
    EGRESS: read_egress,
    VOICE_MAP: lambda message: _field_map(message, "levels", _MOST_DB),
    FIRE: _grid,
    SMOKE: _grid,
    TEMPERATURE: lambda message: _field_map(message, "temperatures", _MOST_C),
}
