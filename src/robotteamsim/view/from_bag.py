"""Recordings of bags: from ROS runs, headless runs, other simulators or real robots."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robotteamsim.analysis.runs.recorded_run import RecordedRobot, RecordedRun, RecordedStatus
from robotteamsim.interface import OUTSIDE
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.view.frame import Frame, Link, Pose, VictimShape, links_of, shown_events
from robotteamsim.view.recorder import FRAME_S, Recording
from robotteamsim.view.scene import scene_of_run


def recording_of(run: RecordedRun, scenario: Scenario | None = None) -> Recording:
    """Return the recording of a run. Args: scenario: its building is drawn instead of the bag's /map."""
    recording = Recording(scene_of_run(run, scenario), run.name)
    count = max(int(np.ceil((run.end_ns - run.start_ns) / 1e9 / FRAME_S)), 0)
    stamps_ns = [*(run.start_ns + np.arange(count) * round(FRAME_S * 1e9)).tolist(), run.end_ns]
    recording.frames = [_frame(run, stamp_ns) for stamp_ns in stamps_ns]
    for stamp_ns, event in run.events:
        recording.events += shown_events([event], (stamp_ns - run.start_ns) / 1e9)
    return recording


def _frame(run: RecordedRun, stamp_ns: int) -> Frame:
    status = _last(run.statuses, [status.stamp_ns for status in run.statuses], stamp_ns)
    victims = _last(run.victims, [stamp for stamp, _ in run.victims], stamp_ns)
    links, fiedler_value = _network(run, stamp_ns)
    return Frame(
        time_s=(stamp_ns - run.start_ns) / 1e9,
        poses=tuple(_pose(robot, stamp_ns) for robot in run.robots),
        swarms=tuple(OUTSIDE if _is_excluded(robot, stamp_ns) else 0 for robot in run.robots),
        links=links,
        fiedler_value=fiedler_value,
        victims=tuple(VictimShape(victim.name, victim.position_m, victim.state) for victim in victims[1])
        if victims
        else (),
        explored=status.explored if status else (),
        target=_target(status),
        state=status.state if status else "",
        noise_db=status.noise_db if status else 0.0,
        endangered=status.endangered_links if status else 0,
    )


def _last(items: Sequence, stamps_ns: Sequence[int], stamp_ns: int):  # type: ignore[no-untyped-def,type-arg]
    index = int(np.searchsorted(stamps_ns, stamp_ns, side="right")) - 1
    return items[index] if index >= 0 else None


def _target(status: RecordedStatus | None) -> int:
    """Return the first area that is not explored; -1 if there is none."""
    if status is None or all(status.explored):
        return -1
    return status.explored.index(False)


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
