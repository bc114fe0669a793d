"""The scans of a recorded run that somebody shows: all of them would not fit into the memory."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from robotteamsim.errors import RecordingError
from robotteamsim.recording.bag_reader import BagReader
from robotteamsim.recording.replay.recorded_run import RecordedRobot, RecordedRun, Timeline
from robotteamsim.recording.topics.base import FARTHEST_M, check_within
from robotteamsim.recording.topics.robots import SCAN

_MOST_RAD = 1e2
"""Larger angles are not measurements, but damage."""


class Scan(NamedTuple):
    """One scan of a laser. ranges_m: float64, shape (beams,); NaN and infinity as in the message."""

    ranges_m: np.ndarray
    angle_min_rad: float
    angle_step_rad: float
    range_max_m: float


def read_scans(run: RecordedRun, robots: Sequence[RecordedRobot], shown_ns: Sequence[int]) -> dict[str, Timeline[Scan]]:
    """Read the scans of robots of a run, by the robots' names.

    Args:   shown_ns: stamps at which scans are shown, in order; only the last ones up to each are kept.
    Raises: RecordingError: the bag cannot be read, or contains impossible scans.
    """
    names = {f"{robot.namespace}/{SCAN.name}": robot.name for robot in robots}
    kept: dict[str, dict[int, tuple[int, Any]]] = {name: {} for name in names.values()}
    with BagReader(run.paths) as bag:
        types = bag.topics
        known = {topic for topic in names if types.get(topic) == SCAN.type_name and bag.is_known(topic)}
        for topic, stamp_ns, message in bag.messages(known):
            of_robot, place = kept[names[topic]], bisect_left(shown_ns, stamp_ns)
            if place not in of_robot or of_robot[place][0] <= stamp_ns:
                of_robot[place] = stamp_ns, message
    found = {}
    for topic, name in names.items():
        try:
            samples = sorted(kept[name].values(), key=lambda sample: sample[0])
            found[name] = Timeline((stamp_ns, _read_scan(message)) for stamp_ns, message in samples)
        except ValueError as error:
            raise RecordingError(f"{', '.join(map(str, run.paths))}: {topic}: {error}") from None
    return found


def _read_scan(message: Any) -> Scan:
    range_max_m = check_within("range_max", message.range_max, FARTHEST_M)
    if range_max_m < 0.0:
        raise ValueError(f"range_max {range_max_m:g}; expected 0 or more")
    angles = check_within("angle_min", message.angle_min, _MOST_RAD), message.angle_increment
    return Scan(
        np.asarray(message.ranges), angles[0], check_within("angle_increment", angles[1], _MOST_RAD), range_max_m
    )
