"""Topics of a recorded run of which only some messages are needed: all scans would not fit into the memory."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Mapping, Sequence
from operator import itemgetter
from typing import Any, NamedTuple

import numpy as np

from robotteamsim.errors import RecordingError
from robotteamsim.recording.bag_reader import BagReader
from robotteamsim.recording.replay.recorded_run import RecordedRun, Timeline
from robotteamsim.recording.topics.base import FARTHEST_M, check_within

_MOST_RAD = 1e2
"""Larger angles are not measurements, but damage."""


class SparseTopic(NamedTuple):
    """A topic with many messages. read: returns the value of one. Raises: ValueError."""

    name: str
    type_name: str
    read: Callable[[Any], Any]


class Scan(NamedTuple):
    """One scan of a laser. ranges_m: shape (beams,); NaN and infinity as in the message."""

    ranges_m: np.ndarray
    angle_min_rad: float
    angle_step_rad: float
    range_max_m: float


def read_sparsely(
    run: RecordedRun, topics: Sequence[SparseTopic], shown_ns: Sequence[int]
) -> Mapping[str, Timeline[Any]]:
    """Read topics of a run again, by their names; one that the bag lacks has no values.

    Args:   shown_ns: stamps in order; of the messages, only the last ones up to each are kept.
    Raises: RecordingError: the bag cannot be read, or contains impossible values.
    """
    kept: dict[str, dict[int, tuple[int, Any]]] = {topic.name: {} for topic in topics}
    with BagReader(run.paths) as bag:
        types = bag.topics
        known = {one.name for one in topics if types.get(one.name) == one.type_name and bag.is_known(one.name)}
        for name, stamp_ns, message in bag.messages(known):
            of_topic, place = kept[name], bisect_left(shown_ns, stamp_ns)
            if place not in of_topic or of_topic[place][0] <= stamp_ns:
                of_topic[place] = stamp_ns, message
    found = {}
    for topic in topics:
        samples = sorted(kept[topic.name].values(), key=itemgetter(0))
        try:
            found[topic.name] = Timeline((stamp_ns, topic.read(message)) for stamp_ns, message in samples)
        except ValueError as error:
            raise RecordingError(f"{', '.join(map(str, run.paths))}: {topic.name}: {error}") from None
    return found


def read_scan(message: Any) -> Scan:
    """Return a sensor_msgs/LaserScan, of any laser. Raises: ValueError: impossible angles or ranges."""
    range_max_m = check_within("range_max", message.range_max, FARTHEST_M)
    if range_max_m < 0.0:
        raise ValueError(f"range_max {range_max_m:g}; expected 0 or more")
    return Scan(
        ranges_m=np.asarray(message.ranges),
        angle_min_rad=check_within("angle_min", message.angle_min, _MOST_RAD),
        angle_step_rad=check_within("angle_increment", message.angle_increment, _MOST_RAD),
        range_max_m=range_max_m,
    )
