"""`robotteamsim analyse`: what bags tell of missions, without ROS."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.progress import track

from robotteamsim import scenario
from robotteamsim.cli.parser import UsageError, positive_number
from robotteamsim.recording.files import atomically, check_replaceable, write_atomically

if TYPE_CHECKING:
    import numpy as np

    from robotteamsim.analysis.runs.derived import RunFigures
    from robotteamsim.analysis.runs.recorded_run import RecordedRun

MAX_DRAWN = 6
"""Bags beside each other in a picture."""

_MIN_FILM_S, _MAX_FILM_S = 1.0, 600.0
_GIF_WIDTH_PX, _GIF_FRAMES_PER_S, _GIF_SAMPLES = 960, 10, 8
_MP4_WIDTH_PX, _MP4_FRAMES_PER_S = 1280, 25

_DESCRIPTION = """\
Tell what bags hold: how the mission went, what the robots drove, how the network held. Bags of
ROS runs and of headless runs, of real robots or of another world with the same topics; compressed
or not. What a bag does not tell is left out and named."""

_EPILOG = """\
Topics: /mission/status, events, victims, areas; /network/state; of each robot odom or
base_pose_ground_truth, contact, controller/status; /map, /tf. Paths come from the true poses,
else from odometry with what /tf tells of it in map.

examples:
  robotteamsim analyse mission.bag
  robotteamsim analyse one.bag two.bag three.bag --json -
  robotteamsim analyse mission.bag --png mission.png --csv tables
  robotteamsim analyse mission.bag --mp4 mission.mp4 --scenario garage_sar --seconds 30
  robotteamsim analyse --join mission_0.bag mission_1.bag mission_2.bag"""


def add_to(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "analyse", help="figures, tables and pictures of bags", description=_DESCRIPTION, epilog=_EPILOG
    )
    parser.add_argument("bags", nargs="+", type=Path, metavar="BAG", help="a bag; several are summarised in one table")
    parser.add_argument(
        "--join", action="store_true", help="the bags are parts of one recording (rosbag record --split)"
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="write figures and events; - prints them instead")
    parser.add_argument("--csv", type=Path, metavar="DIR", help="write figures, events and values over time as tables")
    parser.add_argument("--png", type=Path, metavar="FILE", help=f"draw paths and curves, of up to {MAX_DRAWN} bags")
    parser.add_argument("--gif", type=Path, metavar="FILE", help="film the mission, small, for web pages")
    parser.add_argument("--mp4", type=Path, metavar="FILE", help="film the mission, large, for talks; by ffmpeg")
    parser.add_argument(
        "--seconds", type=positive_number, default=20.0, metavar="S", help="length of the film; default 20"
    )
    parser.add_argument("--scenario", metavar="SCENARIO", help="draw its plan instead of the bag's /map")
    parser.set_defaults(command=analyse)


def analyse(options: argparse.Namespace) -> None:
    """Read all bags, then write what is asked for and print a table."""
    # Imported late: not every command reads bags.
    from robotteamsim.analysis.runs.derived import figures
    from robotteamsim.analysis.runs.recorded_run import read_run

    _check(options)
    plan = scenario.load(options.scenario).plan if options.scenario else None
    runs = [read_run(paths) for paths in ([options.bags] if options.join else [[bag] for bag in options.bags])]
    if len({run.name for run in runs}) < len(runs):  # The folders tell bags of one name apart.
        runs = [replace(run, name=str(bag.with_suffix(""))) for run, bag in zip(runs, options.bags, strict=True)]
    all_figures = [figures(run) for run in runs]
    written = _write(options, runs, all_figures)
    if options.png:
        from robotteamsim.analysis.runs.picture import draw_runs

        with atomically(options.png) as part:
            draw_runs(runs, all_figures, plan).savefig(part, format="png")
        written.append(options.png)
    written += _film(options, runs[0], all_figures[0], plan)
    if options.json != Path("-"):
        _print(runs, all_figures)
        for path in written:
            print(path)


def _check(options: argparse.Namespace) -> None:
    """Refuse what would fail after the bags are read. Raises: UsageError, RecordingError."""
    names = [bag.resolve() for bag in options.bags]
    twice = next((bag for bag, name in zip(options.bags, names, strict=True) if names.count(name) > 1), None)
    if twice:
        raise UsageError(f"{twice} is given twice")
    for path in _files(options):
        check_replaceable(path)
        if not path.parent.is_dir():
            raise UsageError(f"{path}: cannot be written: {path.parent} is no folder")
    if options.png and not options.join and len(options.bags) > MAX_DRAWN:
        raise UsageError(f"--png: {len(options.bags)} bags do not fit beside each other; wanted at most {MAX_DRAWN}")
    if options.gif or options.mp4:
        _check_film(options)


def _check_film(options: argparse.Namespace) -> None:
    from robotteamsim.recording.film_files import find_ffmpeg

    if len(options.bags) > 1 and not options.join:
        raise UsageError(f"a film shows one bag, got {len(options.bags)}; --join is for the parts of one recording")
    if not _MIN_FILM_S <= options.seconds <= _MAX_FILM_S:
        raise UsageError(f"--seconds {options.seconds:g} is not within {_MIN_FILM_S:g} .. {_MAX_FILM_S:g}")
    if options.mp4:
        find_ffmpeg()


def _files(options: argparse.Namespace) -> list[Path]:
    """Return the files to write."""
    return [path for path in (options.json, options.png, options.gif, options.mp4) if path and path != Path("-")]


def _write(options: argparse.Namespace, runs: Sequence[RecordedRun], figures: Sequence[RunFigures]) -> list[Path]:
    from robotteamsim.analysis.runs.files import document, write_tables

    written = write_tables(options.csv, runs, figures) if options.csv else []
    if options.json:
        text = json.dumps(document(runs, figures), indent=1, ensure_ascii=False)
        if options.json == Path("-"):
            print(text)
        else:
            write_atomically(options.json, text + "\n")
            written.append(options.json)
    return written


def _film(
    options: argparse.Namespace, run: RecordedRun, figures: RunFigures, plan: scenario.FloorPlan | None
) -> list[Path]:
    if not (options.gif or options.mp4):
        return []
    from robotteamsim.analysis.runs.film import RunFilm
    from robotteamsim.recording.film_files import find_ffmpeg, write_gif, write_mp4

    if options.gif:
        film, count = RunFilm(run, figures, plan, _GIF_WIDTH_PX), round(options.seconds * _GIF_FRAMES_PER_S)
        write_gif(options.gif, _told(film.frames(count), count), film.frames(_GIF_SAMPLES), _GIF_FRAMES_PER_S)
    if options.mp4:
        film, count = RunFilm(run, figures, plan, _MP4_WIDTH_PX), round(options.seconds * _MP4_FRAMES_PER_S)
        write_mp4(options.mp4, _told(film.frames(count), count), _MP4_FRAMES_PER_S, find_ffmpeg())
    return [path for path in (options.gif, options.mp4) if path]


def _told(frames: Iterator[np.ndarray], count: int) -> Iterator[np.ndarray]:
    """Yield the frames behind a progress bar; silent where there is no terminal."""
    console = Console(stderr=True)
    return iter(track(frames, "film", count, console=console, disable=not console.is_terminal, transient=True))


def _print(runs: Sequence[RecordedRun], figures: Sequence[RunFigures]) -> None:
    from robotteamsim.analysis.runs.tables import print_run, print_runs

    if len(runs) == 1:
        print_run(Console(), runs[0], figures[0])
    else:
        print_runs(Console(), figures)
