"""Reads a run from a bag, or from the parts of one."""

import itertools
import math
import pickle
import re
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from robotteamsim.errors import RecordingError
from robotteamsim.interface import SwarmContext
from robotteamsim.recording.bag_paths import name_of
from robotteamsim.recording.bag_reader import BagReader
from robotteamsim.recording.replay import tracks
from robotteamsim.recording.replay.gaps import Gap, missing_steps, usual_step_ns
from robotteamsim.recording.replay.path_topics import TF_TYPES, PathTopic, left_out, natural, path_topics
from robotteamsim.recording.replay.recorded_run import RecordedNetwork, RecordedRobot, RecordedRun, Series, Timeline
from robotteamsim.recording.replay.tracks import Absence
from robotteamsim.recording.topics import Topic
from robotteamsim.recording.topics.base import read_occupancy_grid
from robotteamsim.recording.topics.decisions import STATUS
from robotteamsim.recording.topics.mission import (
    AREAS,
    EGRESS,
    EVENTS,
    MISSION_STATUS,
    VICTIMS,
    PublishedEvent,
    read_status,
)
from robotteamsim.recording.topics.radio import NETWORK_LINKS, NETWORK_STATE, VOICE_MAP, PublishedNetwork
from robotteamsim.recording.topics.robots import CONTACT
from robotteamsim.recording.topics.world import DOORS, FIRE, MAP, OBJECTS, PEOPLE, ROBOTS, SMOKE, TEMPERATURE
from robotteamsim.scenario.plan import OccupancyGrid
from robotteamsim.scenario.scenario import Role

LAYERS = (DOORS, OBJECTS, PEOPLE, EGRESS, VOICE_MAP, FIRE, SMOKE, TEMPERATURE)
"""What a page shows over time, besides the run."""

_TEAM = (MAP, NETWORK_STATE, NETWORK_LINKS, MISSION_STATUS, EVENTS, VICTIMS, AREAS, EGRESS, ROBOTS, FIRE, SMOKE)
_PATH_TOTALS = ("distance_m", "mean_speed_mps", "max_speed_mps")
_TOTALS_OF_ROBOT = {
    CONTACT.name: ("collisions", "contact_s"),
    STATUS.name: ("excluded_s", "context"),
}
_NETWORK_TOTALS = (
    *("mean_links", "max_hops", "mean_fiedler_value", "min_fiedler_value", "split_s", "endangered_links"),
    "endangered_s",
)
_TOTALS_OF_TEAM = {
    MISSION_STATUS.name: (),
    NETWORK_STATE.name: _NETWORK_TOTALS,
    NETWORK_LINKS.name: _NETWORK_TOTALS,
}
"""Topics with one message per step, and the totals that depend on all of them."""

_LEAVES_OR_COMES = ("robot_removed", "robot_failed_by_heat", "firefighter_collapsed", "robot_spawned")
_TIMELESS = (MAP.name, AREAS.name, ROBOTS.name)
_AT_END = (EGRESS, FIRE, SMOKE)
"""Of which only the last one up to the end of the mission counts."""

_MAX_DISORDER_NS = 10**9
"""Messages may overtake each other by less than this; stamps that go back further belong to a second run."""

_CLOCKS_NS, _ONE_TIME_NS = 10 * 10**9, 86_400 * 10**9
"""Clocks may differ by less than the first, which includes delays; above the second they are not of one kind."""

Samples = Mapping[str, list[tuple[int, Any]]]
"""Stamps [ns] and values by topic."""


class ContentError(RecordingError):
    """A bag is intact, but its contents cannot belong to one run."""


def read_run(paths: Sequence[Path], odometry: Sequence[str] = (), *, layers: bool = True) -> RecordedRun:
    """Read one run from a bag, or from the parts of one.

    Args:   odometry: the topics of the robots' poses; (): those of `path_topics`.
            layers:   whether to read also what only a page shows, which takes memory.
    Raises: RecordingError: a bag cannot be read, contains no run, or contains more than one.
    """
    with BagReader(paths) as bag:
        try:
            return _read(bag, paths, odometry, LAYERS if layers else ())
        except ContentError as error:
            raise RecordingError(f"{', '.join(map(str, paths))}: {error}") from None


def _read(bag: BagReader, files: Sequence[Path], odometry: Sequence[str], layers: Sequence[Topic]) -> RecordedRun:
    try:
        paths = path_topics(bag.topics, odometry)
    except ValueError as error:
        raise ContentError(str(error)) from None
    readers = _readers(bag.topics, paths, layers)
    unread = {topic for topic in readers if not bag.is_known(topic)}
    samples: dict[str, list[tuple[int, Any]]] = defaultdict(list)
    transforms, ended_ns = tracks.Transforms(), math.inf
    last_counts = {topic.name for topic in _AT_END if topic not in layers}
    for topic, stamp_ns, message in bag.messages(set(readers) - unread):
        if bag.topics[topic] in TF_TYPES:
            transforms.add(topic, stamp_ns, message)
            continue
        if topic in last_counts and stamp_ns > ended_ns:
            continue
        if topic in _TIMELESS or topic in last_counts:
            samples[topic].clear()  # Only the last one counts, and maps are large.
        try:
            samples[topic].append((stamp_ns, readers[topic](message)))
            if topic == MISSION_STATUS.name and message.state == "ended":
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
    return _run(files, once, paths, transforms, tuple(sorted(unread)), tuple(notes), bag.topics, layers)


def _readers(
    topics: Mapping[str, str], paths: Mapping[str, PathTopic], layers: Sequence[Topic]
) -> dict[str, Callable[[Any], Any]]:
    """Return the topics to read, each with the function that returns the value of a message.

    The transforms are read only if some robot's true poses are not recorded. Their function is not used.
    """
    of_team = [topic for topic in dict.fromkeys((*_TEAM, *layers)) if topics.get(topic.name) == topic.type_name]
    found = {topic.name: _reader(topic) for topic in of_team}
    if NETWORK_STATE.name in found:
        found.pop(NETWORK_LINKS.name, None)  # The matrices contain the links.
    for namespace, path in paths.items():
        found[path.name] = _pose_sample
        for topic in (CONTACT, STATUS):
            if topics.get(f"{namespace}/{topic.name}") == topic.type_name:
                found[f"{namespace}/{topic.name}"] = _reader(topic)
    if not paths or any(path.source != "truth" for path in paths.values()):
        names = ("tf", "tf_static")
        transforms = (topic for topic, kind in topics.items() if kind in TF_TYPES)
        found |= {topic: _pose_sample for topic in transforms if topic.rpartition("/")[2] in names}
    return found


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
    files: Sequence[Path],
    samples: Samples,
    paths: Mapping[str, PathTopic],
    transforms: tracks.Transforms,
    unread: tuple[str, ...],
    notes: tuple[str, ...],
    topics: Mapping[str, str],
    layers: Sequence[Topic],
) -> RecordedRun:
    samples = _until_end(samples)
    names = {namespace: namespace.strip("/") or "robot" for namespace in paths}
    if {"", "/robot"} <= set(names):
        names[""] = paths[""].name
    by_namespace = {key: _robot(key, names[key], path, samples, transforms) for key, path in paths.items()}
    robots = tuple(filter(None, by_namespace.values()))
    statuses = Timeline(samples.get(MISSION_STATUS.name, ()))
    of_network = next((topic.name for topic in (NETWORK_STATE, NETWORK_LINKS) if topic.name in samples), None)
    network = None if of_network is None else _network(of_network, samples[of_network])
    stamps = [robot.track.stamps_ns[[0, -1]] for robot in robots]
    stamps += [] if network is None else [network.stamps_ns[[0, -1]]]
    stamps += [np.array([statuses[0][0], statuses[-1][0]])] if statuses else []
    if not stamps:
        raise _no_run(topics)
    first_ns, end_ns = int(min(np.min(pair) for pair in stamps)), int(max(np.max(pair) for pair in stamps))
    started_ns = (stamp_ns - round(status.time_s * 1e9) for stamp_ns, status in statuses if status.state == "running")
    return RecordedRun(
        name=name_of(files[0]),
        paths=tuple(files),
        robots=robots,
        statuses=statuses,
        events=Timeline(samples.get(EVENTS.name, ())),
        victims=Timeline(samples.get(VICTIMS.name, ())),
        areas=_last(samples, AREAS) or (),
        network=network,
        grid=_last(samples, MAP),
        start_ns=next(started_ns, first_ns),
        end_ns=end_ns,
        unread=unread,
        egress=_last(samples, EGRESS),
        fire=_last(samples, FIRE),
        smoke=_last(samples, SMOKE),
        gaps=_gaps(samples, paths, by_namespace, _end_ns(samples)),
        notes=notes,
        layers={topic: Timeline(samples.get(topic.name, ())) for topic in layers},
    )


def _no_run(topics: Mapping[str, str]) -> ContentError:
    """Return the error of a bag without a run. Args: topics: their types."""
    more = ", .." if len(topics) > 6 else ""
    shown = [f"{topic} of type {kind}" for topic, kind in list(topics.items())[:6]]
    found = f"found {', '.join(shown)}{more}" if topics else "the bag is empty"
    expected = f"odometry, poses or tf of a robot, {MISSION_STATUS.name} or {NETWORK_STATE.name}"
    return ContentError(f"expected {expected}; {found}")


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


def _last(samples: Samples, topic: Topic) -> Any:
    """Return the last value of a topic; None if there is none."""
    return samples[topic.name][-1][1] if samples.get(topic.name) else None


def _end_ns(samples: Samples) -> int | None:
    """Return the stamp of the mission's end; None if it has not ended."""
    statuses = samples.get(MISSION_STATUS.name, [])
    return next((stamp_ns for stamp_ns, status in statuses if status.state == "ended"), None)


def _until_end(samples: Samples) -> Samples:
    """Return the samples up to the end of the mission; floor plan and areas have no time."""
    ended_ns = _end_ns(samples)
    if ended_ns is None:
        return samples
    cut = {
        topic: of_topic if topic in _TIMELESS else [sample for sample in of_topic if sample[0] <= ended_ns]
        for topic, of_topic in samples.items()
    }
    return {topic: of_topic for topic, of_topic in cut.items() if of_topic}


def _without_copies(topic: str, samples: list[tuple[int, Any]]) -> list[tuple[int, Any]]:
    """Return the samples of a topic without those that were there before, with the same stamp and value."""
    least_ns = 0 if topic == EVENTS.name else 1  # Several events may have one stamp.
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
    absences = _absences([item for item in samples.get(EVENTS.name, []) if item[1].robot_id == robot_id])
    poses = samples.get(path.name, [])
    if path.source == "truth":
        track = tracks.from_truth(poses, absences)
    else:
        track = tracks.from_odometry(poses, transforms, absences, namespace=namespace, source=path.source)
    if track is None:
        return None
    contact, statuses = samples.get(f"{namespace}/{CONTACT.name}"), samples.get(f"{namespace}/{STATUS.name}", [])
    excluded = _series([(stamp_ns, is_excluded) for stamp_ns, (is_excluded, _, _) in statuses], bool)
    swarm = _series([(stamp_ns, number) for stamp_ns, (_, number, _) in statuses], int)
    context = _series([(stamp_ns, values) for stamp_ns, (_, _, values) in statuses if values is not None], float)
    team = _last(samples, ROBOTS)
    roles = team.roles if team and robot_id is not None else ()
    role: Role = roles[robot_id] if robot_id is not None and robot_id < len(roles) else "robot"
    return RecordedRobot(name, robot_id, track, _series(contact, bool), excluded, context, role, namespace, swarm)


def _absences(events: list[tuple[int, PublishedEvent]]) -> tuple[Absence, ...]:
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


def _network(topic: str, samples: list[tuple[int, PublishedNetwork]]) -> RecordedNetwork:
    states = [state for _, state in samples]
    sizes = [len(state.adjacency) for state in states]
    if min(sizes) < max(sizes):
        raise ContentError(f"{topic}: has {min(sizes)} and then {max(sizes)} robots; expected one run per bag")
    signals = [state.signals_dbm for state in states if state.signals_dbm is not None]
    return RecordedNetwork(
        np.array([stamp_ns for stamp_ns, _ in samples]),
        np.array([state.adjacency for state in states], dtype=bool),
        np.array([state.endangered for state in states], dtype=bool),
        np.array([state.hop_count for state in states], dtype=np.int32),
        np.array([state.fiedler_value for state in states], dtype=np.float64),
        np.array(signals, dtype=np.int16) if signals else None,
    )


def _pose_sample(message: Any) -> tracks.PoseSample:
    pose = getattr(message.pose, "pose", message.pose)
    position, q = pose.position, pose.orientation
    return tracks.PoseSample(message.header.frame_id.lstrip("/"), position.x, position.y, q.x, q.y, q.z, q.w)


def _controller_sample(message: Any) -> tuple[bool, int, tuple[float, ...] | None]:
    """Return whether a robot is excluded, its swarm, and the values of `SwarmContext`; None without adaptation."""
    contexts = message.context
    values = tuple(getattr(contexts[0], key) for key in SwarmContext.__struct_fields__) if len(contexts) else None
    return message.excluded, message.swarm, values


def _floor(message: Any) -> OccupancyGrid | None:
    """Return the map, of any program; None if it is rotated, empty or incomplete."""
    info = message.info
    is_complete = 0 < len(message.data) == info.height * info.width and info.resolution > 0.0
    is_straight = math.isclose(info.origin.orientation.z, 0.0, abs_tol=1e-6)
    return read_occupancy_grid(message) if is_complete and is_straight else None


def _reader(topic: Topic) -> Callable[[Any], Any]:
    """Return the function that returns the value of a message."""
    if topic in _READERS:
        return _READERS[topic]
    read = topic.read
    assert read is not None
    return lambda message: read(message, None, None)


_READERS: dict[Topic, Callable[[Any], Any]] = {
    MAP: _floor,
    MISSION_STATUS: read_status,
    CONTACT: lambda message: message.in_contact,
    STATUS: _controller_sample,
}
"""For topics of which a run needs something else than controllers do."""
