"""Reads a run from a bag, or from the parts of one."""

import itertools
import math
import pickle
import re
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from robotteamsim.analysis.runs import tracks
from robotteamsim.analysis.runs.gaps import Gap, missing_steps, usual_step_ns
from robotteamsim.analysis.runs.path_topics import SOURCES, TF_TYPES, PathTopic, left_out, natural, path_topics
from robotteamsim.analysis.runs.recorded_run import (
    RecordedArea,
    RecordedEvent,
    RecordedNetwork,
    RecordedRobot,
    RecordedRun,
    RecordedStatus,
    RecordedVictim,
    Series,
)
from robotteamsim.analysis.runs.tracks import Absence
from robotteamsim.errors import RecordingError
from robotteamsim.interface import SwarmContext
from robotteamsim.mission.egress import Egress, ExitEgress, PersonEgress
from robotteamsim.mission.status import DeliveredDiscoveries
from robotteamsim.network.compact import hops_among, row_bytes, unpacked
from robotteamsim.recording.bag_paths import name_of
from robotteamsim.recording.bag_reader import BagReader
from robotteamsim.recording.topics.mission import EGRESS, read_egress
from robotteamsim.recording.topics.world import FIRE, ROBOTS, ROLES, SMOKE
from robotteamsim.scenario.plan import OccupancyGrid
from robotteamsim.scenario.scenario import Role

STATE, LINKS = "/network/state", "/network/links"

_TEAM_TYPES = {
    "/map": "nav_msgs/OccupancyGrid",
    STATE: "robotteamsim/NetworkState",
    LINKS: "robotteamsim/NetworkLinks",
    "/mission/status": "robotteamsim/MissionStatus",
    "/mission/events": "robotteamsim/MissionEvent",
    "/mission/victims": "robotteamsim/Victims",
    "/mission/areas": "robotteamsim/Areas",
    **{topic.name: topic.type_name for topic in (EGRESS, ROBOTS, FIRE, SMOKE)},
}
_ROBOT_TYPES = {
    "contact": "robotteamsim/Contact",
    "controller/status": "robotteamsim/ControllerStatus",
}
_PATH_TOTALS = ("distance_m", "mean_speed_mps", "max_speed_mps")
_TOTALS_OF_ROBOT = {
    "contact": ("collisions", "contact_s"),
    "controller/status": ("excluded_s", "context"),
}
_NETWORK_TOTALS = (
    *("mean_links", "max_hops", "mean_fiedler_value", "min_fiedler_value", "split_s", "endangered_links"),
    "endangered_s",
)
_TOTALS_OF_TEAM = {"/mission/status": (), STATE: _NETWORK_TOTALS, LINKS: _NETWORK_TOTALS}
"""Topics with one message per step, and the totals that depend on all of them."""

_LEAVES_OR_COMES = ("robot_removed", "robot_failed_by_heat", "firefighter_collapsed", "robot_spawned")
_TIMELESS = ("/map", "/mission/areas", ROBOTS.name)
_AT_END = (EGRESS.name, FIRE.name, SMOKE.name)
"""Of which only the last one up to the end of the mission counts."""

_MAX_DISORDER_NS = 10**9
"""Messages may overtake each other by less than this; stamps that go back further belong to a second run."""

_MOST_M, _MOST_S = 1e6, 1e9
"""Limits of lengths [m] and times [s]; greater ones are impossible."""

_CLOCKS_NS, _ONE_TIME_NS = 10 * 10**9, 86_400 * 10**9
"""Clocks may differ by less than the first, which includes delays; above the second they are not of one kind."""

Samples = Mapping[str, list[tuple[int, Any]]]
"""Stamps [ns] and values by topic."""


class _NetworkSample(NamedTuple):
    """A state of the network; its matrices have the square of the number of robots as their number of values."""

    num_robots: int
    adjacency: np.ndarray
    endangered: np.ndarray
    hop_count: np.ndarray
    fiedler_value: float


class ContentError(RecordingError):
    """A bag is intact, but its contents cannot belong to one run."""


def read_run(paths: Sequence[Path], odometry: Sequence[str] = ()) -> RecordedRun:
    """Read one run from a bag, or from the parts of one.

    Args:   odometry: the topics of the robots' poses; (): those of `path_topics`.
    Raises: RecordingError: a bag cannot be read, contains no run, or contains more than one.
    """
    with BagReader(paths) as bag:
        try:
            return _read(bag, name_of(paths[0]), odometry)
        except ContentError as error:
            raise RecordingError(f"{', '.join(map(str, paths))}: {error}") from None


def _read(bag: BagReader, name: str, odometry: Sequence[str]) -> RecordedRun:
    try:
        paths = path_topics(bag.topics, odometry)
    except ValueError as error:
        raise ContentError(str(error)) from None
    types = _types_to_read(bag.topics, paths)
    unread = {topic for topic in types if not bag.is_known(topic)}
    samples: dict[str, list[tuple[int, Any]]] = defaultdict(list)
    transforms, ended_ns = tracks.Transforms(), math.inf
    for topic, stamp_ns, message in bag.messages(set(types) - unread):
        if types[topic] in TF_TYPES:
            transforms.add(topic, stamp_ns, message)
            continue
        if topic in _AT_END and stamp_ns > ended_ns:
            continue
        if topic in (*_TIMELESS, *_AT_END):
            samples[topic].clear()  # Only the last one counts, and maps are large.
        try:
            samples[topic].append((stamp_ns, _CONVERTERS[types[topic]](stamp_ns, message)))
            if topic == "/mission/status" and message.state == "ended":
                ended_ns = min(ended_ns, stamp_ns)
        except AttributeError:  # This version of the type lacks an attribute.
            unread.add(topic)
        except ValueError as error:
            raise ContentError(f"{topic}: {error}") from None
    if not paths:
        paths = {namespace: PathTopic(f"{namespace}/tf", "tf") for namespace in sorted(transforms.bases, key=natural)}
        samples |= {paths[namespace].name: of_base for namespace, of_base in transforms.bases.items()}
    names = {path.name for path in paths.values()}
    notes = _differing_clocks({topic: late_ns for topic, late_ns in bag.late_ns.items() if topic in names})
    if not odometry and (others := left_out(bag.topics, paths)):
        notes.append(f"{', '.join(others)}: not read, perhaps of more robots; --odometry chooses the topics")
    once = {topic: _without_copies(topic, all_of) for topic, all_of in samples.items() if all_of}
    once = {topic: _in_order(topic, all_of, topic in bag.unstamped) for topic, all_of in once.items()}
    for topic in sorted(names & set(once)):
        if copies := len(samples[topic]) - len(once[topic]):
            notes.append(f"{topic}: {copies} of {len(samples[topic])} messages are copies; each counts once")
        finite = [(stamp_ns, pose) for stamp_ns, pose in once[topic] if tracks.is_finite(pose)]
        if lost := len(once[topic]) - len(finite):
            notes.append(f"{topic}: {lost} of {len(once[topic])} poses are not finite; they are left out")
        once[topic] = finite
    notes += transforms.contradictions({pose.frame for topic in names & set(once) for _, pose in once[topic][:1]})
    return _run(name, once, paths, transforms, tuple(sorted(unread)), tuple(notes), bag.topics)


def _types_to_read(topics: Mapping[str, str], paths: Mapping[str, PathTopic]) -> dict[str, str]:
    """Return the topics to read and their types; tf is read only if some robot's true poses are not recorded."""
    types = {topic: kind for topic, kind in _TEAM_TYPES.items() if topics.get(topic) == kind}
    if STATE in types:
        types.pop(LINKS, None)  # The matrices contain the links.
    for namespace, path in paths.items():
        types[path.name] = topics[path.name]
        of_robot = {f"{namespace}/{name}": kind for name, kind in _ROBOT_TYPES.items()}
        types |= {topic: kind for topic, kind in of_robot.items() if topics.get(topic) == kind}
    if not paths or any(path.source != "truth" for path in paths.values()):
        names = ("tf", "tf_static")
        types |= {
            topic: kind for topic, kind in topics.items() if kind in TF_TYPES and topic.rpartition("/")[2] in names
        }
    return types


def _differing_clocks(late_ns: Mapping[str, int]) -> list[str]:
    """Return a line for each topic of poses whose stamps are of another clock. Args: as `BagReader.late_ns`."""
    if not late_ns:
        return []
    best = min(late_ns, key=lambda topic: abs(late_ns[topic]))
    behind_ns = {topic: late - late_ns[best] for topic, late in late_ns.items()}
    return [
        f"{topic}: its clock is {abs(by_ns) / 1e9:.1f} s {'behind' if by_ns > 0 else 'ahead of'} that of {best}, "
        "by the times of recording"
        for topic, by_ns in behind_ns.items()
        if abs(by_ns) > _CLOCKS_NS and abs(late_ns[best]) < _ONE_TIME_NS  # else the time is simulated
    ]


def _run(
    name: str,
    samples: Samples,
    paths: Mapping[str, PathTopic],
    transforms: tracks.Transforms,
    unread: tuple[str, ...],
    notes: tuple[str, ...],
    topics: Mapping[str, str],
) -> RecordedRun:
    samples = _until_end(samples)
    names = {namespace: namespace.strip("/") or "robot" for namespace in paths}
    if {"", "/robot"} <= set(names):
        names[""] = paths[""].name
    by_namespace = {key: _robot(key, names[key], path, samples, transforms) for key, path in paths.items()}
    robots = tuple(filter(None, by_namespace.values()))
    mission = tuple(status for _, status in samples.get("/mission/status", []))
    network = next((_network(topic, samples[topic]) for topic in (STATE, LINKS) if topic in samples), None)
    stamps = [robot.track.stamps_ns[[0, -1]] for robot in robots]
    stamps += [] if network is None else [network.stamps_ns[[0, -1]]]
    stamps += [np.array([mission[0].stamp_ns, mission[-1].stamp_ns])] if mission else []
    if not stamps:
        more = ", .." if len(topics) > 6 else ""
        shown = [f"{topic} of type {kind}" for topic, kind in list(topics.items())[:6]]
        found = f"found {', '.join(shown)}{more}" if topics else "the bag is empty"
        raise ContentError(f"expected odometry, poses or tf of a robot, /mission/status or {STATE}; {found}")
    first_ns, end_ns = int(min(np.min(pair) for pair in stamps)), int(max(np.max(pair) for pair in stamps))
    started = next((status for status in mission if status.state == "running"), None)
    return RecordedRun(
        name=name,
        robots=robots,
        statuses=mission,
        events=tuple(samples.get("/mission/events", [])),
        victims=tuple(samples.get("/mission/victims", [])),
        areas=samples["/mission/areas"][-1][1] if "/mission/areas" in samples else (),
        network=network,
        grid=_last(samples, "/map"),
        start_ns=started.stamp_ns - round(started.time_s * 1e9) if started else first_ns,
        end_ns=end_ns,
        unread=unread,
        egress=_last(samples, EGRESS.name),
        fire=_last(samples, FIRE.name),
        smoke=_last(samples, SMOKE.name),
        gaps=_gaps(
            samples, paths, by_namespace, next((each.stamp_ns for each in mission if each.state == "ended"), None)
        ),
        notes=notes,
    )


def _gaps(
    samples: Samples,
    paths: Mapping[str, PathTopic],
    by_namespace: Mapping[str, RecordedRobot | None],
    end_ns: int | None,
) -> tuple[Gap, ...]:
    """Return the gaps of all topics with one message per step. Args: end_ns: stamp of the mission's end, if any."""
    topics: list[tuple[str, str, tuple[str, ...], tuple[Absence, ...]]]
    topics = [(topic, "", totals, ()) for topic, totals in _TOTALS_OF_TEAM.items()]
    for namespace, robot in by_namespace.items():
        if robot is not None:
            path, of_robot = paths[namespace], _TOTALS_OF_ROBOT.items()
            of_path = (*_PATH_TOTALS, "trajectory_hash") if path.source == "truth" else _PATH_TOTALS
            topics.append((path.name, robot.name, of_path, robot.track.absences))
            topics += [(f"{namespace}/{kind}", robot.name, totals, robot.track.absences) for kind, totals in of_robot]
    stamps_ns = {topic: np.unique([stamp_ns for stamp_ns, _ in samples.get(topic, [])]) for topic, *_ in topics}
    steps_ns = {topic: usual_step_ns(of_topic) for topic, of_topic in stamps_ns.items()}
    # A topic with one or two messages has the step of the others.
    longest_ns = max((step_ns for step_ns in steps_ns.values() if step_ns is not None), default=None)
    found = []
    for topic, name, totals, absences in topics:
        missing = missing_steps(stamps_ns[topic], absences, end_ns, steps_ns[topic] or longest_ns)
        if missing:
            found.append(Gap(topic, name, missing, len(stamps_ns[topic]) + missing, totals))
    return tuple(found)


def _last(samples: Samples, topic: str) -> Any:
    """Return the last value of a topic; None if there is none."""
    return samples[topic][-1][1] if samples.get(topic) else None


def _until_end(samples: Samples) -> Samples:
    """Return the samples up to the end of the mission; floor plan and areas have no time."""
    statuses = samples.get("/mission/status", [])
    ended_ns = next((stamp_ns for stamp_ns, status in statuses if status.state == "ended"), None)
    if ended_ns is None:
        return samples
    cut = {
        topic: of_topic if topic in _TIMELESS else [sample for sample in of_topic if sample[0] <= ended_ns]
        for topic, of_topic in samples.items()
    }
    return {topic: of_topic for topic, of_topic in cut.items() if of_topic}


def _without_copies(topic: str, samples: list[tuple[int, Any]]) -> list[tuple[int, Any]]:
    """Return the samples of a topic without those that were there before, with the same stamp and value."""
    least_ns = 0 if topic == "/mission/events" else 1  # Several events may have one stamp.
    if topic in _TIMELESS or min(_steps_ns(samples), default=least_ns) >= least_ns:
        return samples
    return list({(stamp_ns, pickle.dumps(value)): (stamp_ns, value) for stamp_ns, value in samples}.values())


def _in_order(topic: str, samples: list[tuple[int, Any]], is_unstamped: bool) -> list[tuple[int, Any]]:
    """Return samples by their stamps. Args: is_unstamped: a stamp was 0, so that the time of recording counts."""
    for (before_ns, _), step_ns in zip(samples, _steps_ns(samples), strict=False):
        if step_ns < -_MAX_DISORDER_NS and topic not in _TIMELESS:
            before_s, after_s = before_ns / 1e9, (before_ns + step_ns) / 1e9
            text = f"time goes back from {before_s:.1f} to {after_s:.1f} s"
            if is_unstamped:
                raise ContentError(f"{topic}: a header has the stamp 0, and with the time of recording instead, {text}")
            raise ContentError(f"{topic}: {text}; expected one run per bag")
    return sorted(samples, key=lambda sample: sample[0])


def _steps_ns(samples: list[tuple[int, Any]]) -> list[int]:
    return [after_ns - before_ns for (before_ns, _), (after_ns, _) in itertools.pairwise(samples)]


def _robot(
    namespace: str, name: str, path: PathTopic, samples: Samples, transforms: tracks.Transforms
) -> RecordedRobot | None:
    number = re.fullmatch(r"robot_(\d+)", name)
    robot_id = int(number[1]) if number else None
    absences = _absences([item for item in samples.get("/mission/events", []) if item[1].robot_id == robot_id])
    poses = samples.get(path.name, [])
    if path.source == "truth":
        track = tracks.from_truth(poses, absences)
    else:
        track = tracks.from_odometry(poses, transforms, absences, namespace=namespace, source=path.source)
    if track is None:
        return None
    contact, statuses = samples.get(f"{namespace}/contact"), samples.get(f"{namespace}/controller/status", [])
    excluded = _series([(stamp_ns, is_excluded) for stamp_ns, (is_excluded, _) in statuses], bool)
    context = _series([(stamp_ns, values) for stamp_ns, (_, values) in statuses if values is not None], float)
    roles = _last(samples, ROBOTS.name) or ()
    role: Role = roles[robot_id] if robot_id is not None and robot_id < len(roles) else "robot"
    return RecordedRobot(name, robot_id, track, _series(contact, bool), excluded, context, role, namespace)


def _absences(events: list[tuple[int, RecordedEvent]]) -> tuple[Absence, ...]:
    """Return the absences of a robot from its events; if the first event is its arrival, it was absent before."""
    changes = [(ns, event.kind == "robot_spawned") for ns, event in events if event.kind in _LEAVES_OR_COMES]
    gone_ns = tracks.BEFORE_ALL_NS if changes and changes[0][1] else None
    absences = []
    for stamp_ns, comes in changes:
        if comes:
            absences.append((stamp_ns if gone_ns is None else gone_ns, stamp_ns))
        gone_ns = None if comes else stamp_ns
    return (*absences, *([] if gone_ns is None else [(gone_ns, tracks.AFTER_ALL_NS)]))


def _series(samples: list[tuple[int, Any]] | None, kind: type) -> Series | None:
    if not samples:
        return None
    return Series(np.array([stamp for stamp, _ in samples]), np.array([value for _, value in samples], dtype=kind))


def _network(topic: str, samples: list[tuple[int, Any]]) -> RecordedNetwork:
    states: list[_NetworkSample] = [state for _, state in samples]
    sizes = [state.num_robots for state in states]
    if min(sizes) < max(sizes):
        raise ContentError(f"{topic}: has {min(sizes)} and then {max(sizes)} robots; expected one run per bag")
    shape = (len(samples), sizes[0], sizes[0])
    return RecordedNetwork(
        np.array([stamp_ns for stamp_ns, _ in samples]),
        np.array([state.adjacency for state in states], dtype=bool).reshape(shape),
        np.array([state.endangered for state in states], dtype=bool).reshape(shape),
        np.array([state.hop_count for state in states], dtype=np.int32).reshape(shape),
        np.array([state.fiedler_value for state in states], dtype=np.float64),
    )


def _pose_sample(stamp_ns: int, message: Any) -> tracks.PoseSample:
    pose = getattr(message.pose, "pose", message.pose)
    position, q = pose.position, pose.orientation
    return tracks.PoseSample(message.header.frame_id.lstrip("/"), position.x, position.y, q.x, q.y, q.z, q.w)


def _controller_sample(stamp_ns: int, message: Any) -> tuple[bool, tuple[float, ...] | None]:
    """Return whether a robot is excluded, and the values of `SwarmContext`; None without adaptation."""
    contexts = message.context
    values = tuple(getattr(contexts[0], key) for key in SwarmContext.__struct_fields__) if len(contexts) else None
    return message.excluded, values


def _network_sample(stamp_ns: int, message: Any) -> _NetworkSample:
    n = message.num_robots
    if not n * n == len(message.adjacency) == len(message.endangered) == len(message.hop_count):
        raise ValueError(f"matrices of {len(message.adjacency)} values; expected {n * n}")
    return _NetworkSample(n, message.adjacency, message.endangered, message.hop_count, message.fiedler_value)


def _links_sample(stamp_ns: int, message: Any) -> _NetworkSample:
    n = message.num_robots
    num_bytes = n * row_bytes(n)
    if not (num_bytes == len(message.adjacency) == len(message.endangered) and n == len(message.present)):
        raise ValueError(f"rows of {len(message.adjacency)} bytes; expected {num_bytes}")
    adjacency, endangered = (
        unpacked(bits.reshape(n, row_bytes(n)), n) for bits in (message.adjacency, message.endangered)
    )
    hops = hops_among(adjacency, message.present != 0)
    return _NetworkSample(n, adjacency, endangered, hops, message.fiedler_value)


def _status(stamp_ns: int, message: Any) -> RecordedStatus:
    delivered = None
    if message.has_base:
        count = int(message.discoveries_delivered)
        delivered = DeliveredDiscoveries(count, message.mean_delivery_delay_s, message.max_delivery_delay_s)
    return RecordedStatus(
        stamp_ns=stamp_ns,
        time_s=_finite("time", message.time_s, _MOST_S),
        scenario=message.scenario,
        state=message.state,
        end=message.end,
        explored=tuple(map(bool, message.explored)),
        victims=tuple(message.victims),
        endangered_links=int(message.endangered_links),
        noise_db=message.noise_db,
        delivered=delivered,
        target_area=int(message.target_area),
    )


def _event(stamp_ns: int, message: Any) -> RecordedEvent:
    time_s = _finite("time", message.time_s, _MOST_S)
    return RecordedEvent(time_s, message.kind, message.subject, message.robot_id, message.detail, message.error_m)


def _victims(stamp_ns: int, message: Any) -> tuple[RecordedVictim, ...]:
    return tuple(RecordedVictim(v.name, _position(v.position), v.state) for v in message.victims)


def _areas(stamp_ns: int, message: Any) -> tuple[RecordedArea, ...]:
    return tuple(
        RecordedArea(a.name, _position(a.center), _finite("radius", a.radius_m, _MOST_M)) for a in message.areas
    )


def _roles(stamp_ns: int, message: Any) -> tuple[Role, ...]:
    """Return the role of each member of the team. Raises: ValueError: an unknown role."""
    numbers = list(message.roles)
    if any(number >= len(ROLES) for number in numbers):
        raise ValueError(f"role {max(numbers)}; expected at most {len(ROLES) - 1}")
    return tuple(ROLES[number] for number in numbers)


def _egress(stamp_ns: int, message: Any) -> Egress:
    egress = read_egress(message)
    parts: tuple[PersonEgress | ExitEgress, ...] = (*egress.people, *egress.exits)
    for part in parts:
        _finite("dose", max(part.gas, part.heat), _MOST_S)
        _finite("visibility", part.visibility_m, _MOST_M)
    times_s = [egress.ignition_s, *(part.untenable_s for part in parts), *(person.out_s for person in egress.people)]
    for time_s in times_s:
        _finite("time", time_s or 0.0, _MOST_S)
    return egress


def _grid(stamp_ns: int, message: Any) -> OccupancyGrid | None:
    """Return the map, or None if it is rotated, empty or incomplete."""
    info, origin = message.info, message.info.origin
    is_complete = 0 < message.data.size == info.height * info.width and info.resolution > 0.0
    if not (is_complete and math.isclose(origin.orientation.z, 0.0, abs_tol=1e-6)):
        return None
    cells = message.data.reshape(info.height, info.width)
    return OccupancyGrid(_position(origin.position), _finite("resolution", info.resolution, _MOST_M), cells)


def _position(point: Any) -> tuple[float, float]:
    return _finite("position", point.x, _MOST_M), _finite("position", point.y, _MOST_M)


def _finite(name: str, value: float, most: float) -> float:
    """Return a number. Raises: ValueError: it is not finite, or impossibly large."""
    if not abs(value) <= most:
        raise ValueError(f"{name} {value:g}; expected at most {most:g}")
    return float(value)


_CONVERTERS: dict[str, Callable[[int, Any], Any]] = {
    **dict.fromkeys(SOURCES, _pose_sample),
    "nav_msgs/OccupancyGrid": _grid,
    "robotteamsim/Contact": lambda stamp_ns, message: message.in_contact,
    "robotteamsim/ControllerStatus": _controller_sample,
    "robotteamsim/NetworkState": _network_sample,
    "robotteamsim/NetworkLinks": _links_sample,
    "robotteamsim/MissionStatus": _status,
    "robotteamsim/MissionEvent": _event,
    "robotteamsim/Victims": _victims,
    "robotteamsim/Areas": _areas,
    EGRESS.type_name: _egress,
    ROBOTS.type_name: _roles,
}
