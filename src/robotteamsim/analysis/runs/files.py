"""The figures of recorded runs as JSON, and their values over time as tables."""

from __future__ import annotations

import csv
import dataclasses
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from robotteamsim.analysis.runs.derived import (
    MissionFigures,
    NetworkFigures,
    RobotTotals,
    RunFigures,
    endangered_links,
    is_split,
    links,
    max_hops,
)
from robotteamsim.analysis.runs.recorded_run import RecordedRun
from robotteamsim.recording.files import atomically, prepare_folder

Row = Sequence[Any]


def document(runs: Sequence[RecordedRun], figures: Sequence[RunFigures]) -> dict[str, Any]:
    """Return figures and events of all bags as plain values for JSON; null where a bag does not tell."""
    return {
        "bags": [
            dataclasses.asdict(figure) | {"events": [dataclasses.asdict(event) for _, event in run.events]}
            for run, figure in zip(runs, figures, strict=True)
        ]
    }


def write_tables(folder: Path, runs: Sequence[RecordedRun], figures: Sequence[RunFigures]) -> list[Path]:
    """Write one CSV file per kind of value; all have the bag in their first column. Raises: RecordingError.

    Times count from the mission's start, or from the first message where there is none [s].
    """
    prepare_folder(folder)
    tables: dict[str, tuple[Row, Iterable[Row]]] = {
        "bags": (_bag_head(), map(_bag_row, figures)),
        "robots": (("bag", *_names(RobotTotals)), (row for figure in figures for row in _robot_rows(figure))),
        "events": (
            ("bag", "time_s", "kind", "subject", "robot_id", "detail"),
            ((run.name, *dataclasses.astuple(event)) for run in runs for _, event in run.events),
        ),
        "progress": (
            (
                "bag",
                "time_s",
                "mission_time_s",
                "state",
                "areas_explored",
                "victims_heard",
                "victims_saved",
                "endangered_links",
            ),
            (row for run in runs for row in _progress_rows(run)),
        ),
        "network": (
            ("bag", "time_s", "links", "max_hops", "split", "fiedler_value", "endangered"),
            (row for run in runs for row in _network_rows(run)),
        ),
        "paths": (
            ("bag", "robot", "frame", "time_s", "x_m", "y_m", "yaw_rad", "driven_m"),
            (row for run in runs for row in _path_rows(run)),
        ),
    }
    written = []
    for name, (head, rows) in tables.items():
        path = folder / f"{name}.csv"
        with atomically(path) as part, part.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(head)
            writer.writerows(rows)
        written.append(path)
    return written


def _names(kind: Any) -> list[str]:
    return [field.name for field in dataclasses.fields(kind)]


def _bag_head() -> Row:
    network = [f"network_{name}" for name in _names(NetworkFigures)]
    return ("bag", "duration_s", *_names(MissionFigures), "distance_m", "collisions", *network, "trajectory_hash")


def _bag_row(figure: RunFigures) -> Row:
    mission = dataclasses.astuple(figure.mission) if figure.mission else (None,) * len(_names(MissionFigures))
    network = dataclasses.astuple(figure.network) if figure.network else (None,) * len(_names(NetworkFigures))
    own = (figure.distance_m, figure.collisions)
    return (figure.bag, figure.duration_s, *mission, *own, *network, figure.trajectory_hash)


def _robot_rows(figure: RunFigures) -> Iterator[Row]:
    for robot in figure.robots:
        yield (figure.bag, *dataclasses.astuple(robot))


def _progress_rows(run: RecordedRun) -> Iterator[Row]:
    for status in run.statuses:
        saved = status.victims.count("saved")
        heard = saved + status.victims.count("heard")
        times_s = (status.stamp_ns - run.start_ns) / 1e9, status.time_s
        yield run.name, *times_s, status.state, sum(status.explored), heard, saved, status.endangered_links


def _network_rows(run: RecordedRun) -> Iterator[Row]:
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
    for row in zip(*(column.tolist() for column in columns), strict=True):
        yield run.name, *row


def _path_rows(run: RecordedRun) -> Iterator[Row]:
    for robot in run.robots:
        track = robot.track
        times_s = run.time_s(track.stamps_ns).tolist()
        for time_s, pose, driven_m in zip(times_s, track.poses.tolist(), track.driven_m.tolist(), strict=True):
            yield run.name, robot.name, track.frame, time_s, *pose, driven_m
