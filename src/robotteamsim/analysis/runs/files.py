"""Totals of recorded runs as JSON, and their time series as CSV tables."""

import csv
import dataclasses
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, get_args

from msgspec.structs import astuple

from robotteamsim.analysis.runs.totals import (
    MissionTotals,
    NetworkTotals,
    RobotTotals,
    RunTotals,
    endangered_links,
    is_split,
    links,
    max_hops,
)
from robotteamsim.interface import SwarmContext
from robotteamsim.mission.egress import ExitEgress, PersonEgress
from robotteamsim.mission.status import VictimState
from robotteamsim.recording.files import atomically, prepare_folder
from robotteamsim.recording.replay.gaps import Gap
from robotteamsim.recording.replay.recorded_run import RecordedRun
from robotteamsim.recording.topics.mission import PublishedEvent
from robotteamsim.wording import safe_cell

Row = Sequence[Any]

_VICTIM_STATES = tuple(state for state in get_args(VictimState) if state != "waiting")

_VICTIMS = ("victim", "located_by", "position_error_m", *(f"{state}_s" for state in _VICTIM_STATES))
_COUNTS = ("areas_explored", "victims_heard", "victims_saved", "endangered_links")


def document(runs: Sequence[RecordedRun], all_totals: Sequence[RunTotals]) -> dict[str, Any]:
    """Return the totals and events of all bags as plain values for JSON; null for values that a bag lacks."""
    return {
        "bags": [
            dataclasses.asdict(totals)
            | {"egress": None if totals.egress is None else totals.egress.values()}
            | {"events": [event.row() for _, event in run.events]}
            for run, totals in zip(runs, all_totals, strict=True)
        ]
    }


def write_tables(folder: Path, runs: Sequence[RecordedRun], all_totals: Sequence[RunTotals]) -> list[Path]:
    """Write one CSV file per kind of value; the first column of each is the bag. Raises: RecordingError.

    Times count from the start of the mission, or from the first message if there is no mission [s].
    """
    prepare_folder(folder)
    paths = table_files(folder)
    for path, (head, rows) in zip(paths, _TABLES.values(), strict=True):
        with atomically(path) as part, part.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(("bag", *head))
            for run, totals in zip(runs, all_totals, strict=True):
                writer.writerows(map(safe_cell, (run.name, *row)) for row in rows(run, totals))
    return paths


def table_files(folder: Path) -> list[Path]:
    """Return the files that `write_tables` writes into a folder."""
    return [folder / f"{name}.csv" for name in _TABLES]


def _names(kind: Any) -> list[str]:
    return [field.name for field in dataclasses.fields(kind)]


def _bag_head() -> Row:
    network = [f"network_{name}" for name in _names(NetworkTotals)]
    last = ("trajectory_hash", "most_missing_steps", "controllers_failed", "controller_failed")
    return ("duration_s", *_names(MissionTotals), "distance_m", "collisions", *network, *last)


def _bag_rows(_: RecordedRun, totals: RunTotals) -> Iterator[Row]:
    mission = dataclasses.astuple(totals.mission) if totals.mission else (None,) * len(_names(MissionTotals))
    network = dataclasses.astuple(totals.network) if totals.network else (None,) * len(_names(NetworkTotals))
    own = (totals.distance_m, totals.collisions)
    missing = max((gap.missing for gap in totals.gaps), default=0)
    last = (totals.trajectory_hash, missing, totals.controllers_failed, totals.controller_failed)
    yield (totals.duration_s, *mission, *own, *network, *last)


def _gap_rows(_: RecordedRun, totals: RunTotals) -> Iterator[Row]:
    for gap in totals.gaps:
        yield (gap.topic, gap.robot, gap.missing, gap.expected, " ".join(gap.totals))


def _event_rows(run: RecordedRun, _: RunTotals) -> Iterator[Row]:
    return (tuple(event.row().values()) for _, event in run.events)


def _robot_rows(_: RecordedRun, totals: RunTotals) -> Iterator[Row]:
    for robot in totals.robots:
        context = robot.context or {}
        means = [context.get(key) for key in SwarmContext.__struct_fields__]
        yield (*(getattr(robot, name) for name in _names(RobotTotals) if name != "context"), *means)


def _robot_names() -> Row:
    """Return the columns of robots; those of the context are means, and empty without adaptation."""
    return (
        *(name for name in _names(RobotTotals) if name != "context"),
        *(f"mean_{key}" for key in SwarmContext.__struct_fields__),
    )


def _context_rows(run: RecordedRun, _: RunTotals) -> Iterator[Row]:
    for robot in run.robots:
        if robot.context is not None:
            for time_s, values in zip(run.time_s(robot.context.stamps_ns), robot.context.values.tolist(), strict=True):
                yield (robot.name, time_s, *values)


def _victim_rows(run: RecordedRun, _: RunTotals) -> Iterator[Row]:
    """Yield when each victim was first in each state, and who first located them how exactly; None: never."""
    events = [event for _, event in run.events]
    names = [victim.name for victim in run.victims[-1][1]] if run.victims else []
    for name in names:
        first: dict[str, PublishedEvent] = {}
        for event in events:
            if event.subject == name:
                first.setdefault(event.kind, event)
        located = first.get("victim_located")
        by, error_m = (located.robot_id, round(located.error_m, 2)) if located else (None, None)
        times_s = [first[kind].time_s if (kind := f"victim_{state}") in first else None for state in _VICTIM_STATES]
        yield name, by, error_m, *times_s


def _person_rows(run: RecordedRun, _: RunTotals) -> Iterator[Row]:
    return map(astuple, run.egress.people if run.egress else ())


def _exit_rows(run: RecordedRun, _: RunTotals) -> Iterator[Row]:
    if run.egress is not None:
        num_out = run.egress.num_out
        for way_out in run.egress.exits:
            yield *astuple(way_out), num_out[way_out.name]


def _progress_rows(run: RecordedRun, _: RunTotals) -> Iterator[Row]:
    for stamp_ns, status in run.statuses:
        saved, heard = status.num_saved, status.num_heard
        times_s = (stamp_ns - run.start_ns) / 1e9, status.time_s
        yield *times_s, status.state, sum(status.explored), heard, saved, status.endangered_links


def _network_rows(run: RecordedRun, _: RunTotals) -> Iterator[Row]:
    if run.network is None:
        return
    network = run.network
    columns = (
        run.time_s(network.stamps_ns),
        links(network),
        max_hops(network),
        is_split(network).astype(int),
        network.fiedler_value,
        endangered_links(network),
    )
    yield from zip(*(column.tolist() for column in columns), strict=True)


def _path_rows(run: RecordedRun, _: RunTotals) -> Iterator[Row]:
    for robot in run.robots:
        track = robot.track
        times_s = run.time_s(track.stamps_ns).tolist()
        for time_s, pose, driven_m in zip(times_s, track.poses.tolist(), track.driven_m.tolist(), strict=True):
            yield robot.name, track.frame, time_s, *pose, driven_m


_TABLES: dict[str, tuple[Row, Callable[[RecordedRun, RunTotals], Iterator[Row]]]] = {
    "bags": (_bag_head(), _bag_rows),
    "gaps": (_names(Gap), _gap_rows),
    "robots": (_robot_names(), _robot_rows),
    "contexts": (("robot", "time_s", *SwarmContext.__struct_fields__), _context_rows),
    "events": (("time_s", "kind", "subject", "robot_id", "detail"), _event_rows),
    "victims": (_VICTIMS, _victim_rows),
    "people": (PersonEgress.__struct_fields__, _person_rows),
    "exits": ((*ExitEgress.__struct_fields__, "people_out"), _exit_rows),
    "progress": (("time_s", "mission_time_s", "state", *_COUNTS), _progress_rows),
    "network": (("time_s", "links", "max_hops", "split", "fiedler_value", "endangered"), _network_rows),
    "paths": (("robot", "frame", "time_s", "x_m", "y_m", "yaw_rad", "driven_m"), _path_rows),
}
"""The columns of each table after that of the bag, and its rows."""
