"""`robotteamsim analyse`: summarise recorded missions from bags, without ROS."""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.progress import track

from robotteamsim import scenario
from robotteamsim.arguments import positive_number
from robotteamsim.cli.output import OutputConsole, add_png_option, check_outputs
from robotteamsim.cli.parser import Parser, UsageError, path_of
from robotteamsim.recording.bag_paths import files_of
from robotteamsim.recording.files import write_atomically
from robotteamsim.wording import counted, printable

if TYPE_CHECKING:
    import numpy as np

    from robotteamsim.analysis.runs.totals import RunTotals
    from robotteamsim.recording.replay.recorded_run import RecordedRun

MAX_DRAWN = 6
"""Most bags drawn side by side in one picture."""

_MIN_FILM_S, _MAX_FILM_S = 1.0, 600.0
_GIF_WIDTH_PX, _GIF_FRAMES_PER_S, _GIF_SAMPLES = 960, 10, 8
_MP4_WIDTH_PX, _MP4_FRAMES_PER_S = 1280, 25

DESCRIPTION = """\
Summarise bags: the course of the mission, the distances driven, the state of the network. Bags may
come from ROS runs, headless runs, real robots or another simulator with the same topics: bags of
ROS 1, or folders, MCAP files and .db3 files of ROS 2, compressed or not. Values that cannot be
computed from a bag are omitted, and listed with the missing topic."""

EPILOG = """\
Topics: /mission/status, events, victims, areas; /network/state or links; for each robot odom or
base_pose_ground_truth, contact, controller/status; /map; tf of the team or in each robot's namespace.
Paths are those of the true poses if the bag has them, else of odometry, transformed to map with tf,
else of poses, else of tf alone.

examples:
  robotteamsim analyse mission.bag
  robotteamsim analyse one.bag two.bag three.bag --json -
  robotteamsim analyse rosbag2_2026_11_28-10_00_00 --odometry /robot1/wheels --odometry /robot2/wheels
  robotteamsim analyse mission.bag --png mission.png --csv tables
  robotteamsim analyse mission.bag --mp4 mission.mp4 --scenario garage_sar --seconds 30
  robotteamsim analyse mission.bag --mp4 mission.mp4 --scenario garage_sar --camera 0
  robotteamsim analyse --join mission_0.bag mission_1.bag mission_2.bag"""


def add_to(parser: Parser) -> None:
    """Describe the command to its parser."""
    parser.add_argument(
        "bags", nargs="+", type=path_of, metavar="BAG", help="one or more bags; several are summarised in one table"
    )
    add_odometry_option(parser)
    parser.add_argument(
        "--join", action="store_true", help="the bags are parts of one recording (rosbag record --split)"
    )
    parser.add_argument("--json", type=path_of, metavar="FILE", help="write totals and events; - prints them instead")
    parser.add_argument("--csv", type=path_of, metavar="DIR", help="write totals, events and time series as tables")
    add_png_option(parser, f"draw paths and curves of up to {MAX_DRAWN} bags", required=False)
    parser.add_argument("--gif", type=path_of, metavar="FILE", help="make a small film for web pages")
    parser.add_argument("--mp4", type=path_of, metavar="FILE", help="make a large film for talks; needs ffmpeg")
    parser.add_argument(
        "--camera",
        type=int,
        metavar="ID",
        help="show in the film what a robot sees, drawn by MuJoCo; needs --scenario",
    )
    parser.add_argument(
        "--seconds", type=positive_number, default=20.0, metavar="S", help="length of the film; default 20"
    )
    parser.add_argument("--scenario", metavar="SCENARIO", help="draw its floor plan instead of the bag's /map")
    parser.set_defaults(command=analyse)


def add_odometry_option(parser: argparse.ArgumentParser) -> None:
    """Add --odometry, which can be repeated."""
    parser.add_argument(
        "--odometry",
        action="append",
        default=[],
        metavar="TOPIC",
        help="the topic of a robot's poses, once for each robot; default: found by name and type",
    )


def analyse(options: argparse.Namespace) -> int:
    """Read all bags, then write the requested files and print a table. Returns: 0, or 1 if a controller failed."""
    # Imported late, because rosbags slows down commands that read no bag.
    from robotteamsim.analysis.runs.files import table_files
    from robotteamsim.analysis.runs.totals import run_totals
    from robotteamsim.recording.replay.reading import read_run

    _check(options)
    loaded = scenario.load(options.scenario) if options.scenario else None
    check_outputs(
        _outputs(options),
        [*(file for bag in options.bags for file in files_of(bag)), *(loaded.origin.files if loaded else ())],
        folders={"--csv": table_files(options.csv)} if options.csv else {},
    )
    plan = loaded.plan if loaded else None
    parts = [options.bags] if options.join else [[bag] for bag in options.bags]
    runs = [read_run(paths, options.odometry, layers=False) for paths in parts]
    if len({run.name for run in runs}) < len(runs):  # Paths distinguish bags of the same name.
        runs = [replace(run, name=str(bag)) for run, bag in zip(runs, options.bags, strict=True)]
    all_totals = [run_totals(run) for run in runs]
    written = _write(options, runs, all_totals)
    if options.png:
        from robotteamsim.analysis.figure_files import write_figure
        from robotteamsim.analysis.runs.picture import draw_runs

        write_figure(draw_runs(runs, all_totals, plan), options.png)
        written.append(options.png)
    written += _film(options, runs[0], all_totals[0], loaded)
    if options.json != Path("-"):
        from robotteamsim.analysis.runs.tables import print_run, print_runs

        if len(runs) == 1:
            print_run(OutputConsole(), runs[0], all_totals[0])
        else:
            print_runs(OutputConsole(), all_totals)
        for file in written:
            print(file)
    if failed := [totals for totals in all_totals if totals.controller_failed]:
        first = f"{failed[0].bag}: {failed[0].controller_failed}"
        text = f"a controller failed in {len(failed)} of {counted(len(all_totals), 'bag')}; the first: {first}"
        print(f"robotteamsim: {printable(text)}", file=sys.stderr)
    return 1 if failed else 0


def _check(options: argparse.Namespace) -> None:
    """Reject options that would fail only after the bags are read. Raises: UsageError."""
    names = [os.path.realpath(bag) for bag in options.bags]
    twice = next((bag for bag, name in zip(options.bags, names, strict=True) if names.count(name) > 1), None)
    if twice:
        raise UsageError(f"{twice} is given twice")
    if options.png and not options.join and len(options.bags) > MAX_DRAWN:
        raise UsageError(f"--png: {len(options.bags)} bags do not fit side by side; expected at most {MAX_DRAWN}")
    for suffix, film in ((".gif", options.gif), (".mp4", options.mp4)):
        if film and film.suffix.lower() != suffix:
            raise UsageError(f"--{suffix[1:]} {film}: expected a name that ends in {suffix}")
    if options.gif or options.mp4:
        _check_film(options)
    if options.camera is not None and not (options.scenario and (options.gif or options.mp4)):
        raise UsageError("--camera: needs --scenario, and --gif or --mp4")


def _check_film(options: argparse.Namespace) -> None:
    from robotteamsim.recording.film_files import find_ffmpeg

    if len(options.bags) > 1 and not options.join:
        raise UsageError(f"a film shows one bag, got {len(options.bags)}; use --join for the parts of one recording")
    if not _MIN_FILM_S <= options.seconds <= _MAX_FILM_S:
        raise UsageError(f"--seconds {options.seconds:g} is outside {_MIN_FILM_S:g} to {_MAX_FILM_S:g} s")
    if options.mp4:
        find_ffmpeg()


def _outputs(options: argparse.Namespace) -> dict[str, Path | None]:
    """Return the files to be written, by option."""
    json_file = None if options.json == Path("-") else options.json
    return {"--json": json_file, "--png": options.png, "--gif": options.gif, "--mp4": options.mp4}


def _write(options: argparse.Namespace, runs: Sequence[RecordedRun], all_totals: Sequence[RunTotals]) -> list[Path]:
    from robotteamsim.analysis.runs.files import document, write_tables

    written = write_tables(options.csv, runs, all_totals) if options.csv else []
    if options.json:
        text = json.dumps(document(runs, all_totals), indent=1, ensure_ascii=False)
        if options.json == Path("-"):
            print(text)
        else:
            write_atomically(options.json, text + "\n")
            written.append(options.json)
    return written


def _film(
    options: argparse.Namespace, run: RecordedRun, totals: RunTotals, loaded: scenario.Scenario | None
) -> list[Path]:
    if not (options.gif or options.mp4):
        return []
    plan, view = loaded.plan if loaded else None, None
    if options.camera is not None and loaded is not None:
        from robotteamsim.analysis.runs.robot_view import RobotView  # MuJoCo is an extra

        view = RobotView(run, loaded, options.camera)
    from robotteamsim.analysis.runs.film import RunFilm
    from robotteamsim.recording.film_files import find_ffmpeg, write_gif, write_mp4

    if options.gif:
        film, count = RunFilm(run, totals, plan, _GIF_WIDTH_PX, view), round(options.seconds * _GIF_FRAMES_PER_S)
        write_gif(options.gif, _with_progress(film.frames(count), count), film.frames(_GIF_SAMPLES), _GIF_FRAMES_PER_S)
    if options.mp4:
        film, count = RunFilm(run, totals, plan, _MP4_WIDTH_PX, view), round(options.seconds * _MP4_FRAMES_PER_S)
        write_mp4(options.mp4, _with_progress(film.frames(count), count), _MP4_FRAMES_PER_S, find_ffmpeg())
    return [file for file in (options.gif, options.mp4) if file]


def _with_progress(frames: Iterator[np.ndarray], count: int) -> Iterator[np.ndarray]:
    """Yield the frames and show a progress bar on a terminal."""
    console = Console(stderr=True)
    return iter(track(frames, "film", count, console=console, disable=not console.is_terminal, transient=True))
