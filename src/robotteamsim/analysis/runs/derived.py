"""The figures of a recorded run: mission, robots, network; and what the bag does not tell."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robotteamsim.analysis.runs.recorded_run import TRUTH, Flags, RecordedNetwork, RecordedRobot, RecordedRun
from robotteamsim.geometry import PoseReading
from robotteamsim.simulation.trajectory_hash import TrajectoryHash

SPEED_WINDOW_S = 1.0
"""Speeds are means over this long: shorter ones of a real robot are mostly the noise of its odometry."""


@dataclass(frozen=True, slots=True)
class MissionFigures:
    """How the mission went; the same figures as `simulation.Result`. end: "" where the bag ends before the mission."""

    scenario: str
    noise_db: float
    end: str
    time_s: float
    areas_explored: int
    num_areas: int
    victims_saved: int
    num_victims: int
    endangered_links: int
    finds_reported: int | None = None
    mean_report_delay_s: float | None = None
    max_report_delay_s: float | None = None


@dataclass(frozen=True, slots=True)
class RobotTotals:
    """What one robot did; None where the bag does not tell.

    source:         what its path is known by.
    max_speed_mps:  the fastest second.
    collisions:     times at which it began to touch something.  contact_s: time in which it did.
    excluded_s:     time as an excluded robot.
    """

    name: str
    source: str
    distance_m: float
    mean_speed_mps: float | None
    max_speed_mps: float | None
    collisions: int | None
    contact_s: float | None
    excluded_s: float | None


@dataclass(frozen=True, slots=True)
class NetworkFigures:
    """The network over the whole run.

    mean_links:       direct links, of num_robots (num_robots - 1) / 2.
    max_hops:         of the longest of the shortest paths; 0 where nobody ever had a link.
    split_s:          time in which some robot could not reach another.
    endangered_links: times a link became endangered.  endangered_s: time in which at least one was.
    """

    num_robots: int
    mean_links: float
    max_hops: int
    mean_fiedler_value: float
    min_fiedler_value: float
    split_s: float
    endangered_links: int
    endangered_s: float


@dataclass(frozen=True, slots=True)
class RunFigures:
    """All figures of one bag; None where it does not tell.

    duration_s:      from the run's first message to its last.
    trajectory_hash: of true poses, where a mission has all robots at the same stamps; equal to `Result`'s.
    left_out:        what could not be computed, and what is missing for it.
    """

    bag: str
    duration_s: float
    mission: MissionFigures | None
    robots: tuple[RobotTotals, ...]
    network: NetworkFigures | None
    trajectory_hash: str | None
    left_out: tuple[str, ...]

    @property
    def title(self) -> str:
        """The bag, and what it holds, in one line."""
        count = len(self.robots) or (self.network.num_robots if self.network else 0)
        team = {0: "", 1: "1 robot"}.get(count, f"{count} robots")
        parts = (self.mission.scenario, team, f"{self.mission.noise_db:g} dB noise") if self.mission else (team,)
        return f"{self.bag}: {', '.join(filter(None, parts))}".removesuffix(": ")

    @property
    def distance_m(self) -> float | None:
        """Length of all paths together [m]."""
        return sum(robot.distance_m for robot in self.robots) if self.robots else None

    @property
    def collisions(self) -> int | None:
        """Of all robots together; None where some robot's are not known."""
        counts = [robot.collisions for robot in self.robots]
        known = [count for count in counts if count is not None]
        return sum(known) if known and len(known) == len(counts) else None


def figures(run: RecordedRun) -> RunFigures:
    """Return the figures of a run."""
    first_ns = min((robot.track.stamps_ns[0] for robot in run.robots), default=run.start_ns)
    return RunFigures(
        bag=run.name,
        duration_s=float(run.end_ns - min(first_ns, run.start_ns)) / 1e9,
        mission=_mission(run),
        robots=tuple(_robot(robot) for robot in run.robots),
        network=None if run.network is None else _network(run.network),
        trajectory_hash=_trajectory_hash(run),
        left_out=left_out(run),
    )


def onsets(values: np.ndarray) -> np.ndarray:
    """Return where something begins to be so: bool, of the shape of `values`, along its first axis."""
    begun = values.copy()
    begun[1:] &= ~values[:-1]
    return begun


def links(network: RecordedNetwork) -> np.ndarray:
    """Return the number of direct links over time, int, shape (n,)."""
    return np.asarray(np.count_nonzero(network.adjacency, axis=(1, 2)) // 2)


def max_hops(network: RecordedNetwork) -> np.ndarray:
    """Return the length of the longest of the shortest paths over time, int, shape (n,)."""
    return np.asarray(network.hop_count.max(axis=(1, 2), initial=0))


def is_split(network: RecordedNetwork) -> np.ndarray:
    """Return whether some robot cannot reach another, over time: bool, shape (n,). Those not there reach nobody."""
    there = network.hop_count.diagonal(axis1=1, axis2=2) == 0
    pairs = there[:, :, np.newaxis] & there[:, np.newaxis, :]
    return np.asarray(((network.hop_count < 0) & pairs).any(axis=(1, 2)))


def endangered_links(network: RecordedNetwork) -> np.ndarray:
    """Return the number of endangered links over time, int, shape (n,)."""
    return np.asarray(np.count_nonzero(network.endangered, axis=(1, 2)) // 2)


def speeds_mps(robot: RecordedRobot) -> tuple[np.ndarray, np.ndarray]:
    """Return the middles [ns] of the seconds of a robot's track, and its mean speed in each [m/s], both shape (n,)."""
    track, window_ns = robot.track, round(SPEED_WINDOW_S * 1e9)
    edges_ns = np.arange(track.stamps_ns[0], track.stamps_ns[-1] + 1, window_ns)
    driven_m = np.interp(edges_ns, track.stamps_ns, track.driven_m)
    return edges_ns[:-1] + window_ns // 2, np.diff(driven_m) / SPEED_WINDOW_S


def _mission(run: RecordedRun) -> MissionFigures | None:
    if not run.statuses:
        return None
    last = run.statuses[-1]
    reports = last.reports
    return MissionFigures(
        scenario=last.scenario,
        noise_db=last.noise_db,
        end=last.end,
        time_s=last.time_s,
        areas_explored=sum(last.explored),
        num_areas=len(last.explored),
        victims_saved=last.victims.count("saved"),
        num_victims=len(last.victims),
        endangered_links=last.endangered_links,
        finds_reported=reports.reported if reports else None,
        mean_report_delay_s=reports.mean_delay_s if reports and reports.reported else None,
        max_report_delay_s=reports.max_delay_s if reports and reports.reported else None,
    )


def _robot(robot: RecordedRobot) -> RobotTotals:
    track = robot.track
    lasted_s = float(track.stamps_ns[-1] - track.stamps_ns[0]) / 1e9
    _, speeds = speeds_mps(robot)
    contact = robot.contact
    return RobotTotals(
        name=robot.name,
        source=track.source,
        distance_m=float(track.driven_m[-1]),
        mean_speed_mps=float(track.driven_m[-1] - track.driven_m[0]) / lasted_s if lasted_s > 0.0 else None,
        max_speed_mps=float(speeds.max()) if len(speeds) else None,
        collisions=None if contact is None else int(onsets(contact.values).sum()),
        contact_s=_lasted_s(contact),
        excluded_s=_lasted_s(robot.excluded),
    )


def _network(network: RecordedNetwork) -> NetworkFigures:
    fresh = onsets(network.endangered)
    return NetworkFigures(
        num_robots=network.adjacency.shape[1],
        mean_links=float(links(network).mean()),
        max_hops=int(max_hops(network).max()),
        mean_fiedler_value=float(network.fiedler_value.mean()),
        min_fiedler_value=float(network.fiedler_value.min()),
        split_s=_time_s(network.stamps_ns, is_split(network)),
        endangered_links=int(fresh.sum()) // 2,
        endangered_s=_time_s(network.stamps_ns, endangered_links(network) > 0),
    )


def _lasted_s(flags: Flags | None) -> float | None:
    return None if flags is None else _time_s(flags.stamps_ns, flags.values)


def _time_s(stamps_ns: np.ndarray, values: np.ndarray) -> float:
    """Return how long something was so: the samples in which it was, times the step between samples [s]."""
    step_s = float(np.median(np.diff(stamps_ns))) / 1e9 if len(stamps_ns) > 1 else 0.0
    return int(values.sum()) * step_s


def _trajectory_hash(run: RecordedRun) -> str | None:
    tracks = [robot.track for robot in run.robots]
    if not (run.statuses and tracks and all(track.source == "truth" for track in tracks)):
        return None
    stamps_ns = tracks[0].stamps_ns
    if not all(np.array_equal(track.stamps_ns, stamps_ns) for track in tracks[1:]):
        return None
    computed = TrajectoryHash()
    columns = [np.column_stack((track.poses[:, :2], track.turns)).tolist() for track in tracks]
    for stamp_ns, *readings in zip(stamps_ns.tolist(), *columns, strict=True):
        computed.update(stamp_ns, [PoseReading(*reading) for reading in readings])
    return computed.hexdigest()


def left_out(run: RecordedRun) -> tuple[str, ...]:
    """Return one line for each thing that the bag does not tell, with what is missing for it."""
    lines = [f"{topic}: its type, or this version of it, is not known" for topic in run.unread]
    if not run.statuses:
        lines.append("mission, areas and victims over time: no /mission/status")
    if not run.events:
        lines.append("events: no /mission/events")
    if run.network is None:
        lines.append("network: no /network/state")
    if not run.robots:
        lines.append(f"paths, distances, speeds: no {TRUTH} and no odom of any robot")
    if lost := [robot.track.frame for robot in run.robots if not robot.track.is_on_map]:
        lines.append(f"paths on the plan: nothing on /tf places {', '.join(lost)} in map")
    lines += _missing("collisions", "contact", [r.name for r in run.robots if r.contact is None], len(run.robots))
    lines += _missing(
        "time excluded", "controller/status", [r.name for r in run.robots if r.excluded is None], len(run.robots)
    )
    if run.grid is None:
        lines.append("plan under the paths: no /map")
    return tuple(lines)


def _missing(what: str, topic: str, names: list[str], count: int) -> list[str]:
    if not names:
        return []
    whose = "any robot" if len(names) == count else ", ".join(names)
    return [f"{what}: no {topic} of {whose}"]
