"""Totals of a recorded run, of its mission, robots and network, and a list of what the bag lacks."""

from dataclasses import dataclass

import numpy as np

from robotteamsim.interface import SwarmContext
from robotteamsim.mission.egress import Egress
from robotteamsim.mission.events import failure_of
from robotteamsim.network import newly_endangered
from robotteamsim.recording.replay.gaps import Gap
from robotteamsim.recording.replay.recorded_run import RecordedNetwork, RecordedRobot, RecordedRun, Series
from robotteamsim.simulation.trial import FASTEST_MPS, TrajectoryHash
from robotteamsim.wording import counted

SPEED_WINDOW_S = 1.0
"""Speeds are means over this time: over shorter times, a real robot's odometry is mostly noise."""


@dataclass(frozen=True, slots=True)
class MissionTotals:
    """The result of the mission, with the values of `simulation.Result`. end: "" if the bag ends before the mission."""

    scenario: str
    noise_db: float
    end: str
    time_s: float
    areas_explored: int
    num_areas: int
    victims_saved: int
    num_victims: int
    endangered_links: int
    discoveries_delivered: int | None = None
    mean_delivery_delay_s: float | None = None
    max_delivery_delay_s: float | None = None


@dataclass(frozen=True, slots=True)
class RobotTotals:
    """The totals of one robot; None where the bag lacks the topic.

    source:         where its path comes from.
    max_speed_mps:  mean speed in the fastest second.
    collisions:     number of times it began to touch something.  contact_s: time in contact.
    excluded_s:     time as an excluded robot.
    context:        means of its metrics and coefficients, by their names in `SwarmContext`; None without adaptation.
    """

    name: str
    source: str
    distance_m: float
    mean_speed_mps: float | None
    max_speed_mps: float | None
    collisions: int | None
    contact_s: float | None
    excluded_s: float | None
    context: dict[str, float] | None = None


@dataclass(frozen=True, slots=True)
class NetworkTotals:
    """The network over the whole run.

    mean_links:       direct links, of at most num_robots (num_robots - 1) / 2.
    max_hops:         length of the longest shortest path; 0 if there never was a link.
    split_s:          time during which the team was disconnected.
    endangered_links: how often a link became endangered (`newly_endangered`).
    endangered_s:     time with at least one endangered link.
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
class RunTotals:
    """All totals of one bag; None where it lacks the topic.

    duration_s:      from the first message of the run to the last.
    trajectory_hash: hash of the true poses, equal to that of `Result`; only for missions in which all robots have poses
                     at the same stamps, and at every step.
    egress:          how people left; None without fire and without exits.
    omitted:         what could not be computed, and the missing topic.
    controllers_failed: number of times that a controller was stopped.  controller_failed: the first one and its reason.
    gaps:            topics that lack steps, and the totals that are computed without them.
    notes:           copies of messages, clocks that differ, jumps of poses.
    """

    bag: str
    duration_s: float
    mission: MissionTotals | None
    robots: tuple[RobotTotals, ...]
    network: NetworkTotals | None
    trajectory_hash: str | None
    omitted: tuple[str, ...]
    egress: Egress | None = None
    controllers_failed: int = 0
    controller_failed: str = ""
    gaps: tuple[Gap, ...] = ()
    notes: tuple[str, ...] = ()

    def lacks_steps(self, total: str, robot: str | None = None) -> bool:
        """Whether a total is computed from a topic with gaps. Args: robot: its name; None: of any robot or the team."""
        return any(total in gap.totals and robot in (None, gap.robot) for gap in self.gaps)

    @property
    def title(self) -> str:
        """The bag, its scenario and its team in one line."""
        count = len(self.robots) or (self.network.num_robots if self.network else 0)
        team = {0: "", 1: "1 robot"}.get(count, f"{count} robots")
        parts = (self.mission.scenario, team, f"{self.mission.noise_db:g} dB noise") if self.mission else (team,)
        return f"{self.bag}: {', '.join(filter(None, parts))}".removesuffix(": ")

    @property
    def distance_m(self) -> float | None:
        """Total length of all paths [m]."""
        return sum(robot.distance_m for robot in self.robots) if self.robots else None

    @property
    def collisions(self) -> int | None:
        """Collisions of all robots; None if those of some robot are unknown."""
        counts = [robot.collisions for robot in self.robots]
        known = [count for count in counts if count is not None]
        return sum(known) if known and len(known) == len(counts) else None


def run_totals(run: RecordedRun) -> RunTotals:
    """Return the totals of a run."""
    first_ns = min((robot.track.stamps_ns[0] for robot in run.robots), default=run.start_ns)
    failed = [event for _, event in run.events if event.kind == "controller_failed"]
    return RunTotals(
        bag=run.name,
        duration_s=float(run.end_ns - min(first_ns, run.start_ns)) / 1e9,
        mission=_mission(run),
        robots=tuple(_robot(robot) for robot in run.robots),
        network=None if run.network is None else _network(run.network),
        trajectory_hash=_trajectory_hash(run),
        omitted=_omitted(run),
        egress=run.egress,
        controllers_failed=len(failed),
        controller_failed=failure_of(failed[0]) if failed else "",
        gaps=run.gaps,
        notes=(*run.notes, *(line for robot in run.robots for line in _jumps(run, robot))),
    )


def onsets(values: np.ndarray) -> np.ndarray:
    """Return where values become True along the first axis: bool, same shape. The first value counts if it is True."""
    begun = values.copy()
    begun[1:] &= ~values[:-1]
    return begun


def links(network: RecordedNetwork) -> np.ndarray:
    """Return the number of direct links over time, int, shape (n,)."""
    return np.asarray(np.count_nonzero(network.adjacency, axis=(1, 2)) // 2)


def max_hops(network: RecordedNetwork) -> np.ndarray:
    """Return the length of the longest shortest path over time [hops], int, shape (n,)."""
    return np.asarray(network.hop_count.max(axis=(1, 2), initial=0))


def is_split(network: RecordedNetwork) -> np.ndarray:
    """Return whether the present robots are disconnected over time: bool, shape (n,)."""
    present = network.hop_count.diagonal(axis1=1, axis2=2) == 0
    pairs = present[:, :, np.newaxis] & present[:, np.newaxis, :]
    return np.asarray(((network.hop_count < 0) & pairs).any(axis=(1, 2)))


def endangered_links(network: RecordedNetwork) -> np.ndarray:
    """Return the number of endangered links over time, int, shape (n,)."""
    return np.asarray(np.count_nonzero(network.endangered, axis=(1, 2)) // 2)


def speeds_mps(robot: RecordedRobot) -> tuple[np.ndarray, np.ndarray]:
    """Return the middle of each second of a robot's track [ns] and its mean speed there [m/s], both of shape (n,)."""
    track, window_ns = robot.track, round(SPEED_WINDOW_S * 1e9)
    edges_ns = np.arange(track.stamps_ns[0], track.stamps_ns[-1] + 1, window_ns)
    driven_m = np.interp(edges_ns, track.stamps_ns, track.driven_m)
    return edges_ns[:-1] + window_ns // 2, np.diff(driven_m) / SPEED_WINDOW_S


def _mission(run: RecordedRun) -> MissionTotals | None:
    if not run.statuses:
        return None
    _, last = run.statuses[-1]
    delivered = last.delivered
    return MissionTotals(
        scenario=last.scenario,
        noise_db=last.noise_db,
        end=last.end,
        time_s=last.time_s,
        areas_explored=sum(last.explored),
        num_areas=len(last.explored),
        victims_saved=last.num_saved,
        num_victims=len(last.victims),
        endangered_links=last.endangered_links,
        discoveries_delivered=delivered.count if delivered else None,
        mean_delivery_delay_s=delivered.mean_delay_s if delivered and delivered.count else None,
        max_delivery_delay_s=delivered.max_delay_s if delivered and delivered.count else None,
    )


def _robot(robot: RecordedRobot) -> RobotTotals:
    track = robot.track
    duration_s = float(track.stamps_ns[-1] - track.stamps_ns[0]) / 1e9
    _, speeds = speeds_mps(robot)
    contact, context = robot.contact, robot.context
    means = [] if context is None else context.values.mean(axis=0).tolist()
    return RobotTotals(
        name=robot.name,
        source=track.source,
        distance_m=float(track.driven_m[-1]),
        mean_speed_mps=float(track.driven_m[-1] - track.driven_m[0]) / duration_s if duration_s > 0.0 else None,
        max_speed_mps=float(speeds.max()) if len(speeds) else None,
        collisions=None if contact is None else int(onsets(contact.values).sum()),
        contact_s=_duration_s(contact),
        excluded_s=_duration_s(robot.excluded),
        context=dict(zip(SwarmContext.__struct_fields__, means, strict=True)) if means else None,
    )


def _network(network: RecordedNetwork) -> NetworkTotals:
    endangered = newly_endangered(network.adjacency, network.endangered, network.hop_count)
    return NetworkTotals(
        num_robots=network.num_robots,
        mean_links=float(links(network).mean()),
        max_hops=int(max_hops(network).max()),
        mean_fiedler_value=float(network.fiedler_value.mean()),
        min_fiedler_value=float(network.fiedler_value.min()),
        split_s=_time_s(network.stamps_ns, is_split(network)),
        endangered_links=int(endangered.sum()) // 2,
        endangered_s=_time_s(network.stamps_ns, endangered_links(network) > 0),
    )


def _duration_s(flags: Series | None) -> float | None:
    return None if flags is None else _time_s(flags.stamps_ns, flags.values)


def _time_s(stamps_ns: np.ndarray, values: np.ndarray) -> float:
    """Return for how long values were True: the number of such samples times the median step between samples [s]."""
    step_s = float(np.median(np.diff(stamps_ns))) / 1e9 if len(stamps_ns) > 1 else 0.0
    return int(values.sum()) * step_s


def _trajectory_hash(run: RecordedRun) -> str | None:
    tracks = [robot.track for robot in run.robots]
    if not (run.statuses and tracks and all(track.source == "truth" for track in tracks)):
        return None
    if any("trajectory_hash" in gap.totals for gap in run.gaps):
        return None
    stamps_ns = tracks[0].stamps_ns
    if not all(np.array_equal(track.stamps_ns, stamps_ns) for track in tracks[1:]):
        return None
    computed = TrajectoryHash()
    true_poses = np.stack([np.column_stack((track.poses[:, :2], track.turns)) for track in tracks], axis=1)
    for stamp_ns, rows in zip(stamps_ns.tolist(), true_poses, strict=True):
        computed.update(stamp_ns, rows)
    return computed.hexdigest()


def _jumps(run: RecordedRun, robot: RecordedRobot) -> list[str]:
    """Return a line if poses jumped, as after a reset of the odometry, or where motion capture lost the robot.

    Passages between levels are no jumps.
    """
    change = "level_changed", robot.robot_id
    changes_ns = {stamp_ns for stamp_ns, event in run.events if (event.kind, event.robot_id) == change}
    jumps = [jump for jump in robot.track.jumps if jump[0] not in changes_ns]
    if not jumps:
        return []
    count, (stamp_ns, length_m) = counted(len(jumps), "jump"), jumps[0]
    first = f"the first of {length_m:.1f} m at {run.time_s(np.array(stamp_ns)):.1f} s"
    what = "resets of the odometry" if robot.track.source.startswith("odom") else "breaks in its recorded poses"
    return [f"{robot.name}: {count} faster than {FASTEST_MPS:g} m/s, {first}: {what}, not driven"]


def _omitted(run: RecordedRun) -> tuple[str, ...]:
    """Return one line for each value that cannot be computed, with the missing topic."""
    lines = [f"{topic}: unknown type, or unknown version of the type" for topic in run.unread]
    if not run.statuses:
        lines.append("mission, areas and victims over time: no /mission/status")
    if not run.events:
        lines.append("events: no /mission/events")
    if run.network is None:
        lines.append("network: no /network/state")
    if not run.robots and (run.network is None or run.network.num_robots):
        lines.append("paths, distances, speeds: no odometry, poses or tf of any robot")
    if lost := [f"{robot.track.frame} of {robot.name}" for robot in run.robots if not robot.track.is_on_map]:
        lines.append(f"paths on the floor plan: no transform on /tf from map to {', '.join(lost)}")
    lines += _missing("collisions", "contact", [r.name for r in run.robots if r.contact is None], len(run.robots))
    lines += _missing(
        "time excluded", "controller/status", [r.name for r in run.robots if r.excluded is None], len(run.robots)
    )
    if run.grid is None:
        lines.append("floor plan: no /map")
    return tuple(lines)


def _missing(what: str, topic: str, names: list[str], count: int) -> list[str]:
    if not names:
        return []
    whose = "any robot" if len(names) == count else ", ".join(names)
    return [f"{what}: no {topic} of {whose}"]
