"""Recordings of bags: from ROS runs, headless runs, other simulators or real robots."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from operator import itemgetter
from pathlib import Path

import msgspec
import numpy as np

from robotteamsim.analysis.runs.reading import read_run
from robotteamsim.analysis.runs.recorded_run import RecordedRobot, RecordedRun
from robotteamsim.errors import RecordingError
from robotteamsim.interface import OUTSIDE
from robotteamsim.recording.hazard_messages import FIRE_GRID, SMOKE_GRID, TEMPERATURE
from robotteamsim.scenario.fire import Fire
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.view.bag_layers import BagLayers, read_layers
from robotteamsim.view.frame import (
    Frame,
    Gait,
    Link,
    Pose,
    VictimShape,
    fallen_of,
    gait_now,
    gait_of,
    links_of,
    shown_events,
)
from robotteamsim.view.hazard_layers import HazardMaps, fire_map, smoke_map
from robotteamsim.view.layer_map import layer_map
from robotteamsim.view.recorder import FRAME_S, MOST_SCANNED, SCAN_S, Recording
from robotteamsim.view.scene import Scene, scene_of_run
from robotteamsim.world.doors import DoorStates

_FRAMES_PER_SCAN = round(SCAN_S / FRAME_S)
_LONGEST_S = 86_400.0
"""A longer recording would make a page that no browser opens; it usually mixes two clocks [s]."""


def recording_of_bag(paths: Sequence[Path], scenario: Scenario | None = None) -> Recording:
    """Return the recording of a bag, or of the parts of one.

    Args:   scenario: its building is drawn instead of the bag's /map.
    Raises: RecordingError.
    """
    return recording_of(read_run(paths), paths, scenario)


def recording_of(run: RecordedRun, paths: Sequence[Path], scenario: Scenario | None = None) -> Recording:
    """Return the recording of a run that was read from bags. Args, Raises: as `recording_of_bag`."""
    scanned = [robot.name for robot in run.robots] if len(run.robots) <= MOST_SCANNED else []
    layers = read_layers(paths, scanned)
    scene = _with_lasers(scene_of_run(run, scenario), layers)
    recording = Recording(scene, run.name)
    duration_s = (run.end_ns - run.start_ns) / 1e9
    if duration_s > _LONGEST_S:
        raise RecordingError(
            f"{', '.join(map(str, paths))}: lasts {duration_s:.0f} s by its stamps; expected at most "
            f"{_LONGEST_S:.0f} s, and stamps of one clock"
        )
    doors = DoorStates.at_start(scenario.plan) if scenario else {}
    gaits = {victim.name: gait_of(victim) for victim in scenario.mission.victims} if scenario else {}
    fallen_ns = _fallen_ns(run)
    at_start = {name: state.opening for name, state in doors.items()}
    count = max(int(np.ceil(duration_s / FRAME_S)), 0)
    stamps_ns = [*(run.start_ns + np.arange(count) * round(FRAME_S * 1e9)).tolist(), run.end_ns]
    recording.frames = [
        msgspec.structs.replace(
            _frame(run, stamp_ns),
            victims=_victims(run, fallen_ns, gaits, layers.enclosed(stamp_ns), stamp_ns),
            links=_links(run, layers, stamp_ns),
            doors=_openings(at_start, layers, stamp_ns),
            scans_m=_scans(scene, layers, stamp_ns) if index % _FRAMES_PER_SCAN == 0 else (),
        )
        for index, stamp_ns in enumerate(stamps_ns)
    ]
    recording.voice = [layer_map((stamp - run.start_ns) / 1e9, found) for stamp, found in layers.voice_maps()]
    for stamp_ns, event in run.events:
        recording.events += shown_events([event], (stamp_ns - run.start_ns) / 1e9)
    fire = scenario.fire if scenario is not None else None
    recording.hazards = _hazards(layers, run.start_ns, (fire or Fire()).heat.block_c)
    has_fire = bool(recording.hazards.fire or recording.hazards.smoke)
    recording.scene = msgspec.structs.replace(recording.scene, has_fire=has_fire)
    return recording


def _hazards(layers: BagLayers, start_ns: int, block_c: float) -> HazardMaps:
    """Return the maps of fire and smoke. Args: block_c: from this temperature on, cells are hot [degC].

    Raises: RecordingError: the floor changes.
    """
    for topic in (FIRE_GRID, SMOKE_GRID):
        if len({(grid.cells.shape, grid.origin_m, grid.resolution_m) for _, grid in layers.maps(topic)}) > 1:
            raise RecordingError(f"{topic}: maps of different sizes or places; expected one floor")
    found = HazardMaps()
    temperatures = dict(layers.maps(TEMPERATURE))
    for stamp_ns, grid in layers.maps(FIRE_GRID):
        time_s, heat = (stamp_ns - start_ns) / 1e9, temperatures.get(stamp_ns)
        is_hot = np.zeros(grid.cells.shape, dtype=bool)
        if heat is not None and heat.values.shape == is_hot.shape:
            is_hot = heat.values >= block_c
        found.add_fire(fire_map(time_s, grid.origin_m, grid.resolution_m, grid.cells, is_hot))
    for stamp_ns, grid in layers.maps(SMOKE_GRID):
        found.add_smoke(smoke_map((stamp_ns - start_ns) / 1e9, grid.origin_m, grid.resolution_m, grid.cells))
    return found


def _with_lasers(scene: Scene, layers: BagLayers) -> Scene:
    """Return the scene with the lasers of the bag; their places on the robots are known only from a scenario."""
    robots = []
    for robot in scene.robots:
        scan = layers.first_scan(robot.name)
        if scan is not None:
            robot = msgspec.structs.replace(
                robot,
                beams=len(scan.ranges_m),
                angle_min_rad=scan.angle_min_rad,
                angle_step_rad=scan.angle_step_rad,
                range_max_m=scan.range_max_m,
            )
        robots.append(robot)
    return msgspec.structs.replace(scene, robots=tuple(robots))


def _links(run: RecordedRun, layers: BagLayers, stamp_ns: int) -> tuple[Link, ...]:
    """Return the links; without signals if the bag has only the compact form of the network."""
    found = layers.links(stamp_ns)
    links = _network(run, stamp_ns)[0] if found is None else found
    places = {robot.robot_id: place for place, robot in enumerate(run.robots) if robot.robot_id is not None}
    if not places:  # robots without a number are in the order of the network
        return links
    pairs = ((places.get(first), places.get(second), signal) for first, second, signal in links)
    return tuple((a, b, signal) for a, b, signal in pairs if a is not None and b is not None)


def _openings(at_start: Mapping[str, float], layers: BagLayers, stamp_ns: int) -> tuple[float, ...]:
    """Return the opening of each door of the scene; of one that the bag does not know, that at the start."""
    known = layers.doors(stamp_ns)
    return tuple(known.get(name, opening) for name, opening in at_start.items())


def _scans(scene: Scene, layers: BagLayers, stamp_ns: int) -> tuple[list[float], ...]:
    scans = [layers.scan(robot.name, stamp_ns) for robot in scene.robots]
    return tuple(scan.ranges_m if scan else [] for scan in scans) if any(scans) else ()


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


def _victims(
    run: RecordedRun,
    fallen_ns: Mapping[str, int],
    gaits: Mapping[str, Gait],
    enclosed: frozenset[str],
    stamp_ns: int,
) -> tuple[VictimShape, ...]:
    """Return the victims. Args: gaits: at the start, by name; others lie.  enclosed: as `gait_now`."""
    index = bisect_right(run.victims, stamp_ns, key=itemgetter(0))
    victims = run.victims[index - 1][1] if index else ()
    fallen = {name for name, since_ns in fallen_ns.items() if since_ns <= stamp_ns}
    return tuple(
        VictimShape(v.name, v.position_m, v.state, gait_now(v.name, gaits.get(v.name, "lies"), fallen, enclosed))
        for v in victims
    )


def _frame(run: RecordedRun, stamp_ns: int) -> Frame:
    index = bisect_right(run.statuses, stamp_ns, key=lambda status: status.stamp_ns)
    status = run.statuses[index - 1] if index else None
    return Frame(
        time_s=(stamp_ns - run.start_ns) / 1e9,
        poses=tuple(_pose(robot, stamp_ns) for robot in run.robots),
        swarms=tuple(OUTSIDE if _is_excluded(robot, stamp_ns) else 0 for robot in run.robots),
        fiedler_value=_network(run, stamp_ns)[1],
        explored=status.explored if status else (),
        target=status.target_area if status else -1,
        state=status.state if status else "",
        noise_db=status.noise_db if status else 0.0,
        endangered=status.endangered_links if status else 0,
    )


def _pose(robot: RecordedRobot, stamp_ns: int) -> Pose | None:
    track = robot.track
    if not track.is_present(stamp_ns) or stamp_ns < track.stamps_ns[0]:
        return None
    x_m, y_m, yaw_rad = track.poses[track.index_at(stamp_ns)].tolist()
    return x_m, y_m, yaw_rad


def _is_excluded(robot: RecordedRobot, stamp_ns: int) -> bool:
    flags = robot.excluded
    if flags is None:
        return False
    index = int(np.searchsorted(flags.stamps_ns, stamp_ns, side="right")) - 1
    return index >= 0 and bool(flags.values[index])


def _network(run: RecordedRun, stamp_ns: int) -> tuple[tuple[Link, ...], float]:
    network = run.network
    if network is None or stamp_ns < network.stamps_ns[0]:
        return (), 0.0
    index = int(np.searchsorted(network.stamps_ns, stamp_ns, side="right")) - 1
    return links_of(network.adjacency[index], None), float(network.fiedler_value[index])
