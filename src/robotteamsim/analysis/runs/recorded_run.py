"""What a bag tells of one run, of this simulation, of another or of real robots; what it does not tell is None."""

from __future__ import annotations

import math
import re
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from robotteamsim.analysis.runs.tracks import (
    AFTER_ALL_NS,
    BEFORE_ALL_NS,
    Absence,
    Track,
    Transforms,
    from_odometry,
    from_truth,
)
from robotteamsim.errors import RecordingError
from robotteamsim.mission.status import Event, Reports
from robotteamsim.recording.bag_reader import BagReader
from robotteamsim.scenario.plan import OccupancyGrid

TRUTH, ODOM = "base_pose_ground_truth", "odom"

_TEAM_TYPES = {
    "/map": "nav_msgs/OccupancyGrid",
    "/network/state": "robotteamsim/NetworkState",
    "/mission/status": "robotteamsim/MissionStatus",
    "/mission/events": "robotteamsim/MissionEvent",
    "/mission/victims": "robotteamsim/Victims",
    "/mission/areas": "robotteamsim/Areas",
}
_ROBOT_TYPES = {
    TRUTH: "nav_msgs/Odometry",
    ODOM: "nav_msgs/Odometry",
    "contact": "robotteamsim/Contact",
    "controller/status": "robotteamsim/ControllerStatus",
}
_TF_TYPES = {"/tf": "tf2_msgs/TFMessage", "/tf_static": "tf2_msgs/TFMessage"}

_LEAVES_OR_COMES = ("robot_removed", "robot_spawned")
_TIMELESS = ("/map", "/mission/areas")

_MAX_DISORDER_NS = 10**9
"""Stamps that go back further than messages overtake each other tell of a second run."""


class ContentError(RecordingError):
    """A bag is whole, but what it tells cannot be of one run."""


@dataclass(frozen=True, slots=True, eq=False)
class Flags:
    """What was so, or not, over time. stamps_ns: int64, shape (n,), ascending. values: bool, shape (n,)."""

    stamps_ns: np.ndarray
    values: np.ndarray


@dataclass(frozen=True, slots=True, eq=False)
class RecordedRobot:
    """What a bag tells of one robot.

    name:     its namespace without slashes; "robot" where it has none.
    robot_id: the number in robot_<number>; None where it is called otherwise.
    """

    name: str
    robot_id: int | None
    track: Track
    contact: Flags | None
    excluded: Flags | None


@dataclass(frozen=True, slots=True, eq=False)
class RecordedNetwork:
    """The network over time.

    stamps_ns:             int64, shape (n,), ascending.
    adjacency, endangered: bool, shape (n, robots, robots).
    hop_count:             int32, shape (n, robots, robots); -1 where no path exists.
    fiedler_value:         float64, shape (n,).
    """

    stamps_ns: np.ndarray
    adjacency: np.ndarray
    endangered: np.ndarray
    hop_count: np.ndarray
    fiedler_value: np.ndarray


@dataclass(frozen=True, slots=True)
class RecordedStatus:
    """The mission at one time, as /mission/status tells it. reports: None where there is no base."""

    stamp_ns: int
    time_s: float
    scenario: str
    state: str
    end: str
    explored: tuple[bool, ...]
    victims: tuple[str, ...]
    endangered_links: int
    noise_db: float
    reports: Reports | None = None


@dataclass(frozen=True, slots=True)
class RecordedVictim:
    """A victim, in `map` [m]; state: waiting, heard or saved."""

    name: str
    position_m: tuple[float, float]
    state: str


@dataclass(frozen=True, slots=True)
class RecordedArea:
    """An area, in `map` [m]."""

    name: str
    center_m: tuple[float, float]
    radius_m: float


@dataclass(frozen=True, slots=True, eq=False)
class RecordedRun:
    """One run, up to the end of its mission where it has one.

    name:      of the bag, without .bag.
    statuses, events, victims: in order of their stamps [ns]; empty where the bag does not have them.
    start_ns:  stamp at which its time is 0: the mission's start, or the first message where there is none.
    end_ns:    stamp of the last message that counts.
    unread:    topics of a type, or a version of it, that is not known.
    """

    name: str
    robots: tuple[RecordedRobot, ...]
    statuses: tuple[RecordedStatus, ...]
    events: tuple[tuple[int, Event], ...]
    victims: tuple[tuple[int, tuple[RecordedVictim, ...]], ...]
    areas: tuple[RecordedArea, ...]
    network: RecordedNetwork | None
    grid: OccupancyGrid | None
    start_ns: int
    end_ns: int
    unread: tuple[str, ...]

    def time_s(self, stamps_ns: np.ndarray) -> np.ndarray:
        """Return the times of stamps, counted from the start [s]."""
        return (stamps_ns - self.start_ns) / 1e9


def read_run(paths: Sequence[Path]) -> RecordedRun:
    """Read one run from a bag, or from the parts of one.

    Raises: RecordingError: a bag that cannot be read, tells nothing of a run, or holds more than one.
    """
    with BagReader(paths) as bag:
        try:
            return _read(bag, paths[0].name.removesuffix(".bag"))
        except ContentError as error:
            raise RecordingError(f"{', '.join(map(str, paths))}: {error}") from None


def _read(bag: BagReader, name: str) -> RecordedRun:
    wanted = _wanted(bag.topics)
    unread = {topic for topic in wanted if not bag.is_known(topic)}
    taken: dict[str, list[tuple[int, Any]]] = defaultdict(list)
    transforms = Transforms()
    for topic, stamp_ns, message in bag.messages(set(wanted) - unread):
        if topic in _TF_TYPES:
            transforms.add(message, is_static=topic == "/tf_static")
            continue
        if topic in _TIMELESS:
            taken[topic].clear()  # The last one counts, and maps are large.
        try:
            taken[topic].append((stamp_ns, _TAKERS[wanted[topic]](message)))
        except AttributeError:  # A version of the type without a field that is needed.
            unread.add(topic)
    return _run(name, taken, transforms, tuple(sorted(unread)), tuple(bag.topics))


def _wanted(topics: Mapping[str, str]) -> dict[str, str]:
    """Return the topics to read, with the types that they must have: tf only where some robot's truth is not there."""
    wanted = {topic: kind for topic, kind in _TEAM_TYPES.items() if topics.get(topic) == kind}
    needs_tf = False
    for namespace in _namespaces(topics):
        mine = {f"{namespace}/{name}": kind for name, kind in _ROBOT_TYPES.items()}
        if topics.get(f"{namespace}/{TRUTH}") == _ROBOT_TYPES[TRUTH]:
            del mine[f"{namespace}/{ODOM}"]
        else:
            needs_tf = True
        wanted |= {topic: kind for topic, kind in mine.items() if topics.get(topic) == kind}
    if needs_tf:
        wanted |= {topic: kind for topic, kind in _TF_TYPES.items() if topics.get(topic) == kind}
    return wanted


def _namespaces(topics: Mapping[str, str]) -> list[str]:
    """Return the namespaces of the robots, robot_2 before robot_10: where there is an odometry, true or not."""
    found = {
        topic.rpartition("/")[0]
        for topic, kind in topics.items()
        if kind == _ROBOT_TYPES[ODOM] and topic.rpartition("/")[2] in (TRUTH, ODOM)
    }
    return sorted(found, key=lambda name: [int(p) if p.isdigit() else p for p in re.split(r"(\d+)", name)])


def _run(
    name: str,
    taken: Mapping[str, list[tuple[int, Any]]],
    transforms: Transforms,
    unread: tuple[str, ...],
    topics: tuple[str, ...],
) -> RecordedRun:
    taken = {topic: _in_order(topic, samples) for topic, samples in taken.items() if samples}
    taken = _until_end(taken)
    robots = tuple(filter(None, (_robot(namespace, taken, transforms) for namespace in _taken_namespaces(taken))))
    mission = tuple(RecordedStatus(stamp, *status) for stamp, status in taken.get("/mission/status", []))
    network = _network(taken["/network/state"]) if "/network/state" in taken else None
    stamps = [robot.track.stamps_ns[[0, -1]] for robot in robots]
    stamps += [] if network is None else [network.stamps_ns[[0, -1]]]
    stamps += [np.array([mission[0].stamp_ns, mission[-1].stamp_ns])] if mission else []
    if not stamps:
        held = f"it holds {', '.join(topics[:6])}{' ..' if len(topics) > 6 else ''}" if topics else "it is empty"
        raise ContentError(f"wanted odom or {TRUTH} of a robot, /mission/status or /network/state; {held}")
    first_ns, end_ns = int(min(np.min(pair) for pair in stamps)), int(max(np.max(pair) for pair in stamps))
    begun = next((status for status in mission if status.state == "running"), None)
    return RecordedRun(
        name=name,
        robots=robots,
        statuses=mission,
        events=tuple(taken.get("/mission/events", [])),
        victims=tuple(taken.get("/mission/victims", [])),
        areas=taken["/mission/areas"][-1][1] if "/mission/areas" in taken else (),
        network=network,
        grid=taken["/map"][-1][1] if "/map" in taken else None,
        start_ns=begun.stamp_ns - round(begun.time_s * 1e9) if begun else first_ns,
        end_ns=end_ns,
        unread=unread,
    )


def _until_end(taken: Mapping[str, list[tuple[int, Any]]]) -> dict[str, list[tuple[int, Any]]]:
    """Leave out what came after the end of the mission; plan and areas are of all times."""
    ended_ns = next((stamp for stamp, status in taken.get("/mission/status", []) if status[2] == "ended"), None)
    if ended_ns is None:
        return dict(taken)
    cut = {
        topic: samples if topic in _TIMELESS else [sample for sample in samples if sample[0] <= ended_ns]
        for topic, samples in taken.items()
    }
    return {topic: samples for topic, samples in cut.items() if samples}


def _taken_namespaces(taken: Mapping[str, Any]) -> list[str]:
    return _namespaces(dict.fromkeys(taken, _ROBOT_TYPES[ODOM]))


def _in_order(topic: str, samples: list[tuple[int, Any]]) -> list[tuple[int, Any]]:
    stamps_ns = np.array([stamp for stamp, _ in samples])
    if len(stamps_ns) > 1 and topic not in _TIMELESS:
        fall = int(np.argmin(np.diff(stamps_ns)))
        if stamps_ns[fall + 1] < stamps_ns[fall] - _MAX_DISORDER_NS:
            before_s, after_s = stamps_ns[fall] / 1e9, stamps_ns[fall + 1] / 1e9
            raise ContentError(
                f"{topic}: time goes back from {before_s:.1f} to {after_s:.1f} s; wanted one run per bag"
            )
    return sorted(samples, key=lambda sample: sample[0])


def _robot(namespace: str, taken: Mapping[str, list[tuple[int, Any]]], transforms: Transforms) -> RecordedRobot | None:
    truth, odom = taken.get(f"{namespace}/{TRUTH}"), taken.get(f"{namespace}/{ODOM}")
    name = namespace.strip("/") or "robot"
    number = re.fullmatch(r"robot_(\d+)", name)
    robot_id = int(number[1]) if number else None
    absences = _absences([item for item in taken.get("/mission/events", []) if item[1].robot_id == robot_id])
    track = from_truth(truth, absences) if truth else from_odometry(odom or [], transforms, absences)
    if track is None:
        return None
    contact, excluded = taken.get(f"{namespace}/contact"), taken.get(f"{namespace}/controller/status")
    return RecordedRobot(name, robot_id, track, _flags(contact), _flags(excluded))


def _absences(events: list[tuple[int, Event]]) -> tuple[Absence, ...]:
    """Return when a robot was not there, by its events: as the first one comes, it was not there before."""
    changes = [(ns, event.kind == "robot_spawned") for ns, event in events if event.kind in _LEAVES_OR_COMES]
    gone_ns = BEFORE_ALL_NS if changes and changes[0][1] else None
    absences = []
    for stamp_ns, comes in changes:
        if comes:
            absences.append((stamp_ns if gone_ns is None else gone_ns, stamp_ns))
        gone_ns = None if comes else stamp_ns
    return (*absences, *([] if gone_ns is None else [(gone_ns, AFTER_ALL_NS)]))


def _flags(samples: list[tuple[int, Any]] | None) -> Flags | None:
    if not samples:
        return None
    return Flags(np.array([stamp for stamp, _ in samples]), np.array([value for _, value in samples], dtype=bool))


def _network(samples: list[tuple[int, Any]]) -> RecordedNetwork:
    sizes = sorted({state[0] for _, state in samples})
    if len(sizes) > 1:
        raise ContentError(f"/network/state: has {sizes[0]} and then {sizes[-1]} robots; wanted one run per bag")
    stamps_ns = np.array([stamp for stamp, _ in samples])
    shape = (len(samples), sizes[0], sizes[0])
    _, adjacency, endangered, hop_count, fiedler_value = zip(*(state for _, state in samples), strict=True)
    return RecordedNetwork(
        stamps_ns,
        np.array(adjacency, dtype=bool).reshape(shape),
        np.array(endangered, dtype=bool).reshape(shape),
        np.array(hop_count, dtype=np.int32).reshape(shape),
        np.array(fiedler_value, dtype=np.float64),
    )


def _take_odometry(message: Any) -> tuple[str, float, float, float, float, float, float]:
    """Return frame, x, y [m] and the quaternion's x, y, z, w."""
    position, q = message.pose.pose.position, message.pose.pose.orientation
    return message.header.frame_id.lstrip("/"), position.x, position.y, q.x, q.y, q.z, q.w


def _take_network(message: Any) -> tuple[int, np.ndarray, np.ndarray, np.ndarray, float]:
    n = message.num_robots
    if not n * n == len(message.adjacency) == len(message.endangered) == len(message.hop_count):
        raise ContentError(f"/network/state: matrices of {len(message.adjacency)} values; wanted {n * n}")
    return n, message.adjacency, message.endangered, message.hop_count, message.fiedler_value


def _take_status(message: Any) -> tuple[Any, ...]:
    return (
        message.time_s,
        message.scenario,
        message.state,
        message.end,
        tuple(map(bool, message.explored)),
        tuple(message.victims),
        int(message.endangered_links),
        message.noise_db,
        # Bags of before the base was heard of do not tell.
        _take_reports(message) if getattr(message, "has_base", False) else None,
    )


def _take_reports(message: Any) -> Reports:
    return Reports(int(message.finds_reported), message.mean_report_delay_s, message.max_report_delay_s)


def _take_event(message: Any) -> Event:
    return Event(message.time_s, message.kind, message.subject, message.robot_id, message.detail)


def _take_victims(message: Any) -> tuple[RecordedVictim, ...]:
    return tuple(RecordedVictim(v.name, (v.position.x, v.position.y), v.state) for v in message.victims)


def _take_areas(message: Any) -> tuple[RecordedArea, ...]:
    return tuple(RecordedArea(a.name, (a.center.x, a.center.y), a.radius_m) for a in message.areas)


def _take_grid(message: Any) -> OccupancyGrid | None:
    """Return the map; None where it is turned, empty or less than it says."""
    info, origin = message.info, message.info.origin
    is_whole = 0 < message.data.size == info.height * info.width and info.resolution > 0.0
    if not (is_whole and math.isclose(origin.orientation.z, 0.0, abs_tol=1e-6)):
        return None
    cells = message.data.reshape(info.height, info.width)
    return OccupancyGrid((origin.position.x, origin.position.y), float(info.resolution), cells)


_TAKERS: dict[str, Callable[[Any], Any]] = {
    "nav_msgs/Odometry": _take_odometry,
    "nav_msgs/OccupancyGrid": _take_grid,
    "robotteamsim/Contact": lambda message: message.in_contact,
    "robotteamsim/ControllerStatus": lambda message: message.excluded,
    "robotteamsim/NetworkState": _take_network,
    "robotteamsim/MissionStatus": _take_status,
    "robotteamsim/MissionEvent": _take_event,
    "robotteamsim/Victims": _take_victims,
    "robotteamsim/Areas": _take_areas,
}
