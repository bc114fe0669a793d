"""One recorded run of this simulator, another one, or real robots; values that the bag lacks are None or empty."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass, field
from operator import itemgetter
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from robotteamsim.mission.egress import Egress
from robotteamsim.recording.replay.gaps import Gap
from robotteamsim.recording.replay.tracks import Track
from robotteamsim.recording.topics import Topic
from robotteamsim.recording.topics.mission import PublishedArea, PublishedEvent, PublishedStatus, PublishedVictim
from robotteamsim.scenario.plan import OccupancyGrid
from robotteamsim.scenario.scenario import Role

Value = TypeVar("Value")
Default = TypeVar("Default")


class Timeline(tuple[tuple[int, Value], ...]):
    """Values with their stamps [ns], in the order of the stamps."""

    __slots__ = ()

    def at(self, stamp_ns: int, before: Default) -> Value | Default:
        """Return the last value up to a stamp. Args: before: returned if there is none yet."""
        index = bisect_right(self, stamp_ns, key=itemgetter(0))
        return self[index - 1][1] if index else before


@dataclass(frozen=True, slots=True, eq=False)
class Series:
    """Values over time. stamps_ns: int64, shape (n,), ascending. values: shape (n, ...)."""

    stamps_ns: np.ndarray
    values: np.ndarray

    def at(self, stamp_ns: int) -> Any:
        """Return the last value up to a stamp [ns], or the first one if there is none."""
        return self.values[max(int(np.searchsorted(self.stamps_ns, stamp_ns, side="right")) - 1, 0)]


@dataclass(frozen=True, slots=True, eq=False)
class RecordedRobot:
    """One robot.

    name:     its namespace without slashes; without one, "robot", or its topic if that is the name of another one.
    robot_id: the number in robot_<number>; None for other names.
    contact, excluded: bool.  swarm: the number of its swarm.
    context:  its metrics and coefficients while it adapts, in the order of `SwarmContext`: float64, shape (n, 10); None
              without adaptation.
    role:     in the team.
    """

    name: str
    robot_id: int | None
    track: Track
    contact: Series | None
    excluded: Series | None
    context: Series | None = None
    role: Role = "robot"
    namespace: str = ""
    swarm: Series | None = None


@dataclass(frozen=True, slots=True, eq=False)
class RecordedNetwork:
    """The network over time.

    stamps_ns:             int64, shape (n,), ascending.
    adjacency, endangered: bool, shape (n, robots, robots).
    hop_count:             int32, shape (n, robots, robots); -1 if no path exists.
    fiedler_value:         float64, shape (n,).
    signals_dbm:           of links, int16, shape (n, robots, robots), rounded [dBm]; None if only links are recorded.
    """

    stamps_ns: np.ndarray
    adjacency: np.ndarray
    endangered: np.ndarray
    hop_count: np.ndarray
    fiedler_value: np.ndarray
    signals_dbm: np.ndarray | None = None

    @property
    def num_robots(self) -> int:
        """Number of robots; 0 in studies of people alone."""
        return int(self.adjacency.shape[1])


@dataclass(frozen=True, slots=True, eq=False)
class RecordedRun:
    """One run, up to the end of its mission if it has one.

    name:      name of the bag without its suffix.  paths: of the bag, or of the parts of one.
    statuses, events, victims: empty if the bag lacks them.
    areas:     as of the last message.
    start_ns:  stamp of time 0: the start of the mission, or the first message if there is no mission.
    end_ns:    stamp of the last message of the run.
    unread:    topics whose type, or version of the type, is unknown.
    egress, fire, smoke: the last ones; None if the bag lacks them. Grids as in /fire/grid and /smoke/grid.
    gaps:      topics with one message per step that lack some.
    notes:     lines about copies of messages, and clocks that differ.
    layers:    what a page shows over time besides, by topic: see `reading.LAYERS`; {} if that was not read.
    """

    name: str
    paths: tuple[Path, ...]
    robots: tuple[RecordedRobot, ...]
    statuses: Timeline[PublishedStatus]
    events: Timeline[PublishedEvent]
    victims: Timeline[tuple[PublishedVictim, ...]]
    areas: tuple[PublishedArea, ...]
    network: RecordedNetwork | None
    grid: OccupancyGrid | None
    start_ns: int
    end_ns: int
    unread: tuple[str, ...]
    egress: Egress | None = None
    fire: OccupancyGrid | None = None
    smoke: OccupancyGrid | None = None
    gaps: tuple[Gap, ...] = ()
    notes: tuple[str, ...] = ()
    layers: Mapping[Topic, Timeline[Any]] = field(default_factory=dict)

    def layer(self, topic: Topic) -> Timeline[Any]:
        """Return a layer; an empty one if it was not read."""
        return self.layers.get(topic, Timeline())

    def time_s(self, stamps_ns: np.ndarray) -> np.ndarray:
        """Return the times of stamps, counted from the start [s]."""
        return (stamps_ns - self.start_ns) / 1e9
