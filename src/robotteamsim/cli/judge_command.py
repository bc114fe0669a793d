"""`robotteamsim judge`: judge a bag by the mission of a scenario."""

from __future__ import annotations

import argparse
import json

from rich.console import Console

from robotteamsim import scenario
from robotteamsim.cli.analyse_command import add_odometry_option
from robotteamsim.cli.interrupt import InterruptBetweenSteps
from robotteamsim.cli.output import OutputConsole, check_outputs
from robotteamsim.cli.parser import Parser, path_of
from robotteamsim.cli.progress import ProgressBar
from robotteamsim.cli.run_command import SCENARIO_HELP, add_set_option, exit_status, failures_in
from robotteamsim.recording import result_summary
from robotteamsim.recording.bag_paths import files_of
from robotteamsim.recording.measures import Measures
from robotteamsim.recording.results import EventList
from robotteamsim.setup import resolve
from robotteamsim.simulation import Observer
from robotteamsim.wording import printable

DESCRIPTION = """\
Judge a bag of any team by the mission of a scenario: which areas it explored, whom it heard and
saved, and when. The poses of the robots come from the bag, as `robotteamsim analyse` finds them;
what their controllers say, too, if the bag has /robot_<id>/controller/status and network/tx. The
rest is computed as in a simulation: voices, radio, people, fire, scheduled doors, the rules."""

EPILOG = """\
A bag of this simulator gives the result of its mission, step by step; --set repeats the settings of
the run, such as run.seed. The mission begins with the first pose. Robots are matched by their
numbers, robot_<id>, or else in the order of their names; one without poses is absent.

examples:
  robotteamsim judge mission.bag --mission garage_sar --set run.seed=7
  robotteamsim judge real.bag --mission my_house.yaml --set robots.count=2 --json
  robotteamsim judge real.bag --mission my_house.yaml --html mission.html
  robotteamsim judge mission_0.bag mission_1.bag --mission garage_sar      two parts of one recording"""


def add_to(parser: Parser) -> None:
    """Describe the command to its parser."""
    parser.add_argument("bags", nargs="+", type=path_of, metavar="BAG", help="a bag, or the parts of one")
    parser.add_argument("--mission", required=True, metavar="SCENARIO", help=SCENARIO_HELP)
    add_set_option(parser)
    add_odometry_option(parser)
    parser.add_argument("--html", type=path_of, metavar="FILE", help="write what was judged as a page for any browser")
    parser.add_argument("--json", action="store_true", help="print result and events as one JSON object")
    parser.add_argument("--quiet", action="store_true", help="no progress bar, no table")
    parser.set_defaults(command=judge)


def judge(options: argparse.Namespace) -> int:
    """Judge the bag, and print what it says. Returns: 0, or 1 if a controller failed."""
    # Imported late, because rosbags slows down commands that read no bag.
    from robotteamsim.analysis.runs import judged
    from robotteamsim.analysis.runs.tables import gap_lines, print_result
    from robotteamsim.recording.replay.reading import read_run

    loaded = scenario.load(options.mission, options.overrides)
    bags = [file for bag in options.bags for file in files_of(bag)]
    check_outputs({"--html": options.html}, [*bags, *loaded.origin.files])
    setup, events, measures = resolve(loaded), EventList(), Measures()
    observers: list[Observer] = [events, measures, InterruptBetweenSteps()]
    if options.html:
        from robotteamsim.view.html import PageWriter

        observers.append(PageWriter(options.html, setup))
    if not options.quiet:
        observers.append(ProgressBar(Console(stderr=True)))
    run = read_run(options.bags, options.odometry, layers=False)
    result = judged.judge(run, setup, observers)
    notes = [*run.notes, *(f"{topic}: not read, of an unknown type" for topic in run.unread), *gap_lines(run.gaps)]
    if not result.end:
        notes.append("the recording ends before the mission does")
    num_failed, reason = failures_in(events.events)
    if options.json:
        failures = {"controllers_failed": num_failed, "controller_failed": reason}
        rows = {"events": [event.row() for event in events.events], "notes": notes}
        print(json.dumps(result_summary(result) | measures.values() | failures | rows))
    elif not options.quiet:
        written = [options.html] if options.html else []
        print_result(OutputConsole(), result, events.events, written, measures.measured)
        for note in notes:
            print(f"  {printable(note)}")
    return exit_status(num_failed, reason)
