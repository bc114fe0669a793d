"""Recordings of bags: from ROS runs, headless runs, other simulators or real robots."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import msgspec
import numpy as np

from robotteamsim.errors import RecordingError
from robotteamsim.interface import OUTSIDE
from robotteamsim.recording.replay.recorded_run import RecordedRobot, RecordedRun, Timeline
from robotteamsim.recording.replay.sparse import Scan, SparseTopic, read_scan, read_sparsely
from robotteamsim.recording.topics import Topic
from robotteamsim.recording.topics.beliefs import FOUND_MAP, LOCALISATION
from robotteamsim.recording.topics.mission import EGRESS, PublishedStatus
from robotteamsim.recording.topics.radio import VOICE_MAP
from robotteamsim.recording.topics.robots import SCAN
from robotteamsim.recording.topics.world import DOORS, FIRE, OBJECTS, PEOPLE, SMOKE, TEMPERATURE
from robotteamsim.scenario.fire import Fire
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sensors import Sensor
from robotteamsim.scenario.sensors.base import reading_of
from robotteamsim.setup import Setup, resolve
from robotteamsim.view.found import FoundLayers
from robotteamsim.view.frame import (
    Frame,
    Link,
    Pose,
    enclosed_of,
    fallen_of,
    finite_ranges,
    gait_of,
    links_of,
    sensor_texts,
    shown_beliefs,
    shown_egress,
    shown_events,
    shown_objects,
    victim_shape,
)
from robotteamsim.view.layers import SMOKE_S, field_layer, fire_layer, keep_map, smoke_layer
from robotteamsim.view.recorder import FRAME_S, MOST_SCANNED, RADIO_S, SCAN_S, RadioCoverage, Recording
from robotteamsim.view.scene import Scene, object_shape, scene_of_run
from robotteamsim.world.contract import NO_OBJECTS
from robotteamsim.world.doors import DoorStates

Scanned = Mapping[str, Timeline[Any]]
"""Scans and readings of sensors by topic, where they are shown."""

MOST_FRAMES = 18_000
"""An hour of the viewer's frames; those of longer runs are farther apart."""

_FOUND_NS, _MOST_FOUND = 5_000_000_000, 200
"""Least time between two maps that a robot has found, and most of them: all would not fit into the memory."""

_LONGEST_S = 86_400.0
"""A longer recording would make a page that no browser opens; it usually mixes two clocks [s]."""


def recording_of(run: RecordedRun, scenario: Scenario | None = None) -> Recording:
    """Return the recording of a run that was read from a bag, or from the parts of one, with its layers.

    Args:   scenario: its building is drawn instead of the bag's /map.
    Raises: RecordingError.
    """
    duration_s = (run.end_ns - run.start_ns) / 1e9
    if duration_s > _LONGEST_S:
        raise RecordingError(
            f"{', '.join(map(str, run.paths))}: lasts {duration_s:.0f} s by its stamps; expected at most "
            f"{_LONGEST_S:.0f} s, and stamps of one clock"
        )
    num_scanned = len(run.robots) if scenario is None else scenario.num_robots
    stamps_ns, per_scan = _frame_stamps(run)
    setup = None if scenario is None else resolve(scenario)
    topics = _scanned(run, setup) if num_scanned <= MOST_SCANNED else []
    scanned = read_sparsely(run, topics, stamps_ns[::per_scan])
    beliefs = read_sparsely(run, _topics_of(run, LOCALISATION), stamps_ns)
    _check_floor(run)
    scene = _with_objects(_with_lasers(scene_of_run(run, setup), run, scanned), run)
    found = Recording(scene, run.name, _frames(run, scanned, beliefs, setup, scene))
    for stamp_ns, event in run.events:
        found.events += shown_events([event], (stamp_ns - run.start_ns) / 1e9)
    for stamp_ns, levels in run.layer(VOICE_MAP):
        found.voice.append(field_layer((stamp_ns - run.start_ns) / 1e9, levels, 0.0))
    if scenario is not None:
        coverage = RadioCoverage(scenario)
        every = max(round(RADIO_S * (len(found.frames) - 1) / duration_s), 1) if duration_s else 1
        found.radio = [level for frame in found.frames[::every] for level in coverage.at(frame)]
    fire = scenario.fire if scenario is not None else None
    if setup is not None and setup.scenario.control.map == "unknown" and num_scanned <= MOST_SCANNED:
        _add_found(found, run, setup)
    _add_hazards(found, run, (fire or Fire()).heat.block_c)
    has_beliefs = any(frame.beliefs for frame in found.frames)
    found.scene = msgspec.structs.replace(scene, has_fire=bool(found.fire or found.smoke), has_beliefs=has_beliefs)
    return found


def _check_floor(run: RecordedRun) -> None:
    """Raises: RecordingError: maps of one topic have different sizes or places."""
    cells: tuple[tuple[Topic, str], ...] = (VOICE_MAP, "values"), (FIRE, "cells"), (SMOKE, "cells")
    for topic, name in cells:
        maps = [one for _, one in run.layer(topic)]
        if len({(getattr(one, name).shape, one.origin_m, one.resolution_m) for one in maps}) > 1:
            files = ", ".join(map(str, run.paths))
            raise RecordingError(f"{files}: {topic.name}: maps of different sizes or places; expected one floor")


def _frame_stamps(run: RecordedRun) -> tuple[list[int], int]:
    """Return the stamps of the frames [ns], and one in how many of them has scans."""
    duration_s = (run.end_ns - run.start_ns) / 1e9
    frame_s = max(FRAME_S, duration_s / MOST_FRAMES)
    count = max(int(np.ceil(duration_s / frame_s)), 0)
    stamps_ns = [*(run.start_ns + np.arange(count) * round(frame_s * 1e9)).tolist(), run.end_ns]
    return stamps_ns, max(round(SCAN_S / frame_s), 1)


def _scanned(run: RecordedRun, setup: Setup | None) -> list[SparseTopic]:
    """Return the topics of the scans, and those of the sensors that a scenario knows."""
    topics = [SparseTopic(f"{robot.namespace}/{SCAN.name}", SCAN.type_name, read_scan) for robot in run.robots]
    for robot in run.robots:
        for sensor in _sensors(robot, setup):
            type_name = next(iter(sensor.topics.values()))
            topics.append(SparseTopic(_topic(robot, sensor), type_name, partial(_possible_reading, robot, sensor)))
    return topics


def _possible_reading(robot: RecordedRobot, sensor: Sensor, message: Any) -> Any:
    """Return the reading of a message; None: it is impossible, or of another version. Raises: SensorError."""
    try:
        return reading_of(sensor, robot.robot_id or 0, message)
    except ValueError:
        return None


def _sensors(robot: RecordedRobot, setup: Setup | None) -> Sequence[Sensor]:
    """Return the `robots.sensors` of a robot whose readings are shown."""
    if setup is None or robot.robot_id is None or robot.robot_id >= len(setup.robots):
        return ()
    sensors = setup.robots[robot.robot_id].sensors
    return [sensor for sensor in sensors if sensor.topics and type(sensor).text is not Sensor.text]


def _topic(robot: RecordedRobot, sensor: Sensor) -> str:
    """Return the topic from which a sensor's readings are made, its first one."""
    return f"{robot.namespace}/{next(iter(sensor.topics))}"


def _topics_of(run: RecordedRun, topic: Topic) -> list[SparseTopic]:
    """Return a topic of each robot."""
    read = topic.read
    assert read is not None
    return [SparseTopic(f"{robot.namespace}/{topic.name}", topic.type_name, read) for robot in run.robots]


def _frames(run: RecordedRun, scanned: Scanned, beliefs: Scanned, setup: Setup | None, scene: Scene) -> list[Frame]:
    """Return a frame each `FRAME_S`, or fewer of a long run, and one at the end, of the last values up to each."""
    known = setup.scenario.mission.victims if setup else ()
    gaits = {victim.name: gait_of(victim) for victim in known}
    fallen_ns = _fallen_ns(run)
    at_start = DoorStates.at_start(setup.plan) if setup else DoorStates()
    places = {robot.robot_id: place for place, robot in enumerate(run.robots) if robot.robot_id is not None}
    stamps_ns, frames_per_scan = _frame_stamps(run)
    frames = []
    for index, stamp_ns in enumerate(stamps_ns):
        status = run.statuses.at(stamp_ns, _BEFORE_MISSION)
        doors: DoorStates = run.layer(DOORS).at(stamp_ns, at_start)
        enclosed = enclosed_of(run.layer(PEOPLE).at(stamp_ns, ()))
        fallen = {name for name, since_ns in fallen_ns.items() if since_ns <= stamp_ns}
        links, fiedler_value = _network(run, stamp_ns)
        shown = run.robots if scanned and index % frames_per_scan == 0 else ()
        scans = [scanned[f"{robot.namespace}/{SCAN.name}"].at(stamp_ns, None) for robot in shown]
        sensors = tuple(_sensed(robot, _sensors(robot, setup), scanned, stamp_ns) for robot in shown)
        frames.append(
            Frame(
                time_s=(stamp_ns - run.start_ns) / 1e9,
                poses=tuple(_pose(robot, stamp_ns) for robot in run.robots),
                swarms=tuple(_swarm(robot, stamp_ns) for robot in run.robots),
                links=_among(places, links),
                fiedler_value=fiedler_value,
                doors=tuple(doors.get(name, state).opening for name, state in at_start.items()),
                objects=shown_objects((obj.name for obj in scene.objects), run.layer(OBJECTS).at(stamp_ns, NO_OBJECTS)),
                victims=tuple(
                    victim_shape(v.name, v.position_m, v.state, gaits.get(v.name, "lies"), fallen, enclosed)
                    for v in run.victims.at(stamp_ns, ())
                ),
                explored=status.explored,
                target=status.target_area,
                state=status.state,
                noise_db=status.noise_db,
                endangered=status.endangered_links,
                scans_m=tuple(map(_shown_scan, scans)) if any(scans) else (),
                egress=shown_egress(run.layer(EGRESS).at(stamp_ns, None)),
                sensors=sensors if any(sensors) else (),
                beliefs=shown_beliefs(
                    beliefs[f"{robot.namespace}/{LOCALISATION.name}"].at(stamp_ns, None) for robot in run.robots
                ),
            )
        )
    return frames


_BEFORE_MISSION = PublishedStatus()


def _sensed(robot: RecordedRobot, sensors: Sequence[Sensor], scanned: Scanned, stamp_ns: int) -> dict[str, str]:
    """Return the last readings of a robot's sensors in words; none of an absent robot. Raises: SensorError."""
    if _pose(robot, stamp_ns) is None:
        return {}
    readings = {sensor.name: scanned[_topic(robot, sensor)].at(stamp_ns, None) for sensor in sensors}
    known = {name: reading for name, reading in readings.items() if reading is not None}
    return sensor_texts(robot.robot_id or 0, sensors, known)


def _shown_scan(scan: Scan | None) -> list[float]:
    """Return ranges from 0 to that of the laser, which also stands for beams without return; [] without a scan."""
    if scan is None:
        return []
    return finite_ranges(np.clip(scan.ranges_m, 0.0, scan.range_max_m), scan.range_max_m)


def _add_found(found: Recording, run: RecordedRun, setup: Setup) -> None:
    """Add the maps that robots have found of the building of a scenario."""
    layers = FoundLayers(setup.plan)
    every_ns = max(_FOUND_NS, (run.end_ns - run.start_ns) // _MOST_FOUND)
    maps = read_sparsely(run, _topics_of(run, FOUND_MAP), range(run.start_ns, run.end_ns + every_ns, every_ns))
    for index, robot in enumerate(run.robots):
        for stamp_ns, grid in maps[f"{robot.namespace}/{FOUND_MAP.name}"]:
            found.add_found(index, layers.layer((stamp_ns - run.start_ns) / 1e9, grid))


def _add_hazards(found: Recording, run: RecordedRun, block_c: float) -> None:
    """Add the maps of fire and smoke. Args: block_c: from this temperature on, cells are hot [degC]."""
    temperatures = dict(run.layer(TEMPERATURE))
    for stamp_ns, grid in run.layer(FIRE):
        heat = temperatures.get(stamp_ns)
        is_hot = np.zeros(grid.cells.shape, dtype=bool)
        if heat is not None and heat.values.shape == is_hot.shape:
            is_hot = heat.values >= block_c
        time_s = (stamp_ns - run.start_ns) / 1e9
        keep_map(found.fire, fire_layer(time_s, grid.origin_m, grid.resolution_m, grid.cells, is_hot))
    for stamp_ns, grid in run.layer(SMOKE):
        time_s = (stamp_ns - run.start_ns) / 1e9
        keep_map(found.smoke, smoke_layer(time_s, grid.origin_m, grid.resolution_m, grid.cells), SMOKE_S)


def _with_lasers(scene: Scene, run: RecordedRun, scanned: Scanned) -> Scene:
    """Return the scene with the lasers of the bag; their places on the robots are known only from a scenario."""
    robots = []
    for robot, recorded in zip(scene.robots, run.robots, strict=True):
        if scans := scanned.get(f"{recorded.namespace}/{SCAN.name}"):
            _, scan = scans[0]
            robot = msgspec.structs.replace(
                robot,
                beams=len(scan.ranges_m),
                angle_min_rad=scan.angle_min_rad,
                angle_step_rad=scan.angle_step_rad,
                range_max_m=scan.range_max_m,
            )
        robots.append(robot)
    return msgspec.structs.replace(scene, robots=tuple(robots))


def _with_objects(scene: Scene, run: RecordedRun) -> Scene:
    """Return the scene with all objects that the bag has at some time."""
    shapes = {obj.name: object_shape(obj) for _, states in run.layer(OBJECTS) for obj in states.models}
    return msgspec.structs.replace(scene, objects=tuple(shapes.values()))


def _among(places: dict[int, int], links: tuple[Link, ...]) -> tuple[Link, ...]:
    """Return links of robots by their places in the run. Args: places: by robot_id; {}: the robots have none."""
    if not places:  # robots without a number are in the order of the network
        return links
    return tuple((places[a], places[b], signal) for a, b, signal in links if a in places and b in places)


def _fallen_ns(run: RecordedRun) -> dict[str, int]:
    """Return since when victims have collapsed [ns], by name."""
    found: dict[str, int] = {}
    for stamp_ns, event in run.events:
        for name in fallen_of([event]):
            found.setdefault(name, stamp_ns)
    for stamp_ns, victims in run.victims:  # a bag may begin after a collapse
        for victim in victims:
            if victim.state == "collapsed":
                found[victim.name] = min(stamp_ns, found.get(victim.name, stamp_ns))
    return found


def _pose(robot: RecordedRobot, stamp_ns: int) -> Pose | None:
    track = robot.track
    if not track.is_present(stamp_ns) or stamp_ns < track.stamps_ns[0]:
        return None
    x_m, y_m, yaw_rad = track.poses[track.index_at(stamp_ns)].tolist()
    return x_m, y_m, yaw_rad


def _swarm(robot: RecordedRobot, stamp_ns: int) -> int:
    """Return the swarm of a robot, as of the last status of its controller."""
    if robot.excluded is None or robot.swarm is None or stamp_ns < robot.swarm.stamps_ns[0]:
        return 0
    return OUTSIDE if robot.excluded.at(stamp_ns) else int(robot.swarm.at(stamp_ns))


def _network(run: RecordedRun, stamp_ns: int) -> tuple[tuple[Link, ...], float]:
    network = run.network
    if network is None or stamp_ns < network.stamps_ns[0]:
        return (), 0.0
    index = int(np.searchsorted(network.stamps_ns, stamp_ns, side="right")) - 1
    signals_dbm = None if network.signals_dbm is None else network.signals_dbm[index]
    return links_of(network.adjacency[index], signals_dbm), float(network.fiedler_value[index])
