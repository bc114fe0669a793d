"""One recorded run of this simulator, another one, or real robots; values that the bag lacks are None or empty."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from robotteamsim.analysis.runs.gaps import Gap
from robotteamsim.analysis.runs.tracks import Track
from robotteamsim.mission.egress import Egress
from robotteamsim.mission.status import SAVED, DeliveredDiscoveries
from robotteamsim.scenario.plan import OccupancyGrid
from robotteamsim.scenario.scenario import Role


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
    contact, excluded: bool.
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


@dataclass(frozen=True, slots=True, eq=False)
class RecordedNetwork:
    """The network over time.

    stamps_ns:             int64, shape (n,), ascending.
    adjacency, endangered: bool, shape (n, robots, robots).
    hop_count:             int32, shape (n, robots, robots); -1 if no path exists.
    fiedler_value:         float64, shape (n,).
    """

    stamps_ns: np.ndarray
    adjacency: np.ndarray
    endangered: np.ndarray
    hop_count: np.ndarray
    fiedler_value: np.ndarray

    @property
    def num_robots(self) -> int:
        """Number of robots; 0 in studies of people alone."""
        return int(self.adjacency.shape[1])


@dataclass(frozen=True, slots=True)
class RecordedStatus:
    """The mission at one time, from /mission/status.

    delivered:   discoveries at the base; None if there is no base.
    target_area: index of the area to explore; -1 if none is left.
    """

    stamp_ns: int
    time_s: float
    scenario: str
    state: str
    end: str
    explored: tuple[bool, ...]
    victims: tuple[str, ...]
    endangered_links: int
    noise_db: float
    delivered: DeliveredDiscoveries | None = None
    target_area: int = -1

    @property
    def num_saved(self) -> int:
        """Number of victims who are saved or safe."""
        return sum(state in SAVED for state in self.victims)

    @property
    def num_heard(self) -> int:
        """Number of victims who have been heard or found."""
        return sum(state != "waiting" for state in self.victims)


@dataclass(frozen=True, slots=True)
class RecordedVictim:
    """A victim, in `map` [m]; state: see `mission.status.VictimState`."""

    name: str
    position_m: tuple[float, float]
    state: str


@dataclass(frozen=True, slots=True)
class RecordedArea:
    """An area, in `map` [m]."""

    name: str
    center_m: tuple[float, float]
    radius_m: float


@dataclass(frozen=True, slots=True)
class RecordedEvent:
    """An event of the mission, from /mission/events: see `mission.events.Event`.

    error_m: of the event `victim_located` [m].
    """

    time_s: float
    kind: str
    subject: str
    robot_id: int
    detail: str
    error_m: float = 0.0

    def row(self) -> dict[str, Any]:
        """Return what every event has, by key."""
        return {key: value for key, value in asdict(self).items() if key != "error_m"}


@dataclass(frozen=True, slots=True, eq=False)
class RecordedRun:
    """One run, up to the end of its mission if it has one.

    name:      name of the bag without its suffix.
    statuses, events, victims: in order of their stamps [ns]; empty if the bag lacks them.
    start_ns:  stamp of time 0: the start of the mission, or the first message if there is no mission.
    end_ns:    stamp of the last message of the run.
    unread:    topics whose type, or version of the type, is unknown.
    egress, fire, smoke: the last ones; None if the bag lacks them. Grids as in /fire/grid and /smoke/grid.
    gaps:      topics with one message per step that lack some.
    notes:     lines about copies of messages, and clocks that differ.
    """

    name: str
    robots: tuple[RecordedRobot, ...]
    statuses: tuple[RecordedStatus, ...]
    events: tuple[tuple[int, RecordedEvent], ...]
    victims: tuple[tuple[int, tuple[RecordedVictim, ...]], ...]
    areas: tuple[RecordedArea, ...]
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

    def time_s(self, stamps_ns: np.ndarray) -> np.ndarray:
        """Return the times of stamps, counted from the start [s]."""
        return (stamps_ns - self.start_ns) / 1e9
