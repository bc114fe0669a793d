"""`robotteamsim run`: run one mission as fast as possible."""

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from robotteamsim import recording, scenario
from robotteamsim.analysis.runs.tables import print_result, print_timings
from robotteamsim.arguments import number, whole_number
from robotteamsim.cli.interrupt import InterruptBetweenSteps
from robotteamsim.cli.output import OutputConsole, check_outputs
from robotteamsim.cli.parser import Parser, UsageError, path_of
from robotteamsim.cli.progress import ProgressBar, working
from robotteamsim.control import foreign_code
from robotteamsim.errors import ScenarioError
from robotteamsim.mission.events import Event, failure_of
from robotteamsim.recording import ResultWriter, TumWriter, result_summary
from robotteamsim.recording.measures import Measures
from robotteamsim.recording.results import FILE_NAME, EventList
from robotteamsim.simulation import Observer, Simulation
from robotteamsim.simulation.controllers import check_constructed
from robotteamsim.wording import counted, printable

ALLOW_CODE = "--allow-code"
TRAJECTORIES = "trajectories"
"""The folder of trajectories within --out."""
SCENARIO_HELP = f"a file, or a shipped scenario: {', '.join(scenario.scenario_names())}"

DESCRIPTION = """\
Run one mission and print its events and totals. The same scenario and seed give
bit-identical trajectories, headless and in ROS with lockstep:=true."""

EPILOG = """\
--out writes mission.json (result, all events, all settings, versions) and
trajectories/robot_<id>.tum. --bag writes the same topics as a ROS run; play it back
with `roslaunch robotteamsim replay.launch bag:=...`. --mcap writes them as ROS 2 messages,
which Foxglove, Lichtblick and Rerun show (`robotteamsim new layout`), and leads from the map to
each robot's true place in /tf. All replace what an earlier run has written under that name.

examples:
  robotteamsim run garage_sar --seed 7 --noise 20 --out results --bag mission.bag
  robotteamsim run garage_sar --robots 5 --set mission.time_limit_s=300
  robotteamsim run garage_sar --html mission.html
  robotteamsim run garage_sar --timings
  robotteamsim run garage_sar --json | jq .trajectory_hash"""


def add_to(parser: Parser) -> None:
    """Describe the command to its parser."""
    parser.add_argument("scenario", metavar="SCENARIO", help=SCENARIO_HELP)
    add_scenario_options(parser)
    parser.add_argument("--out", type=path_of, metavar="DIR", help="write mission.json and trajectories to this folder")
    parser.add_argument("--bag", type=path_of, metavar="FILE", help="write a ROS bag of the run")
    parser.add_argument(
        "--mcap", type=path_of, metavar="FILE", help="write an MCAP file of the run, with ROS 2 messages"
    )
    parser.add_argument("--html", type=path_of, metavar="FILE", help="write the mission as a page for any browser")
    parser.add_argument("--json", action="store_true", help="print the result as one JSON object instead of a table")
    parser.add_argument("--timings", action="store_true", help="print where the time of a step goes, too")
    parser.add_argument("--quiet", action="store_true", help="no progress bar, no table")
    parser.set_defaults(command=run)


def add_scenario_options(parser: argparse.ArgumentParser) -> None:
    """Add the options that `load_scenario` and `check_code` read."""
    parser.add_argument("--seed", type=whole_number, metavar="N", help="seed of all random numbers (run.seed)")
    parser.add_argument("--noise", type=number, metavar="DB", help="background noise [dB] (voice.noise_db)")
    parser.add_argument("--robots", type=whole_number, metavar="N", help="number of robots (robots.count)")
    add_set_option(parser)
    add_code_option(parser)


def add_set_option(parser: argparse.ArgumentParser) -> None:
    """Add --set, which can be repeated."""
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        dest="overrides",
        metavar="K=V",
        help="override any value of the scenario, such as control.alpha=0.5; repeatable",
    )


def add_code_option(parser: argparse.ArgumentParser) -> None:
    """Add --allow-code."""
    parser.add_argument(
        ALLOW_CODE,
        action="store_true",
        help="let control.algorithm in a file be any Python class, module:Class, or policy.pt, whose code then runs",
    )


def check_code(options: argparse.Namespace, loaded: scenario.Scenario) -> None:
    """Raises: ScenarioError: the scenario's file names a class to run, and --allow-code is not given."""
    if not options.allow_code:
        foreign_code.check_scenario(loaded, ALLOW_CODE)


def run(options: argparse.Namespace) -> int:
    """Run the mission. Returns: 0, or 1 if a controller failed."""
    if (Path(options.scenario) / FILE_NAME).is_file() and options.scenario not in scenario.scenario_names():
        raise UsageError(f"{options.scenario}: is a folder of `run --out`; `robotteamsim view` shows its mission")
    loaded = load_scenario(options, options.scenario)
    _check_files(options, loaded)
    check_code(options, loaded)
    console = Console(stderr=True, quiet=options.quiet)
    with working(console, loaded.name, "preparing"):
        simulation = Simulation(loaded)
    check_constructed(simulation.controllers, loaded)
    if options.timings:
        simulation.time_stages()
    events, measures = EventList(), Measures()
    observers: list[Observer] = [events, measures, *_recorders(options)]
    if options.html:
        from robotteamsim.view.html import PageWriter

        observers.append(PageWriter(options.html, simulation.setup))
    if not options.quiet:
        observers.append(ProgressBar(console))
    observers.append(InterruptBetweenSteps())
    result = simulation.run(observers)
    num_failed, reason = failures_in(events.events)
    if options.json:
        failures = {"controllers_failed": num_failed, "controller_failed": reason}
        timings = {"timings": [time._asdict() for time in simulation.timings()]} if options.timings else {}
        print(json.dumps(result_summary(result) | measures.values() | failures | timings))
    elif not options.quiet:
        written = [options.out, options.bag, options.mcap, options.html]
        print_result(OutputConsole(), result, events.events, written, measures.measured)
        if options.timings:
            print_timings(OutputConsole(), simulation.timings())
    return exit_status(num_failed, reason)


def failures_in(events: Sequence[Event]) -> tuple[int, str]:
    """Return how many controllers failed in a mission, and the first reason."""
    failed = [event for event in events if event.kind == "controller_failed"]
    return len(failed), failure_of(failed[0]) if failed else ""


def exit_status(num_failed: int, reason: str) -> int:
    """Return 1, with a line for the user, if a controller failed; else 0."""
    if num_failed:
        text = printable(f"{counted(num_failed, 'controller')} failed; the first: {reason}")
        print(f"robotteamsim: {text}", file=sys.stderr)
    return 1 if num_failed else 0


def _check_files(options: argparse.Namespace, loaded: scenario.Scenario) -> None:
    """Raises: UsageError: a file would be overwritten that this command reads, or writes as well."""
    if options.mcap and options.mcap.suffix != ".mcap":
        raise UsageError(f"--mcap {options.mcap}: expected a name that ends in .mcap")
    if options.bag and options.bag.suffix == ".mcap":
        raise UsageError(f"--bag {options.bag}: is a name of MCAP files, which --mcap writes")
    files = {"--bag": options.bag, "--mcap": options.mcap, "--html": options.html}
    result = options.out / FILE_NAME if options.out else None
    for option, path in files.items():
        if options.out and path and (options.out / TRAJECTORIES).resolve() in path.resolve().parents:
            raise UsageError(f"{option} {path}: would be among the files of --out; choose another folder")
    check_outputs(files, loaded.origin.files, folders={"--out": [result] if result else []})


def load_scenario(options: argparse.Namespace, name: str) -> scenario.Scenario:
    """Return a scenario with all overrides of the command line; named options take precedence over --set.

    Raises: ScenarioError: names the option as the user typed it.
    """
    noise_db = None if options.noise is None else f"{options.noise:g}"
    named = {
        "--seed": ("run.seed", options.seed),
        "--noise": ("voice.noise_db", noise_db),
        "--robots": ("robots.count", options.robots),
    }
    given = {option: (key, value) for option, (key, value) in named.items() if value is not None}
    try:
        return scenario.load(name, [*options.overrides, *(f"{key}={value}" for key, value in given.values())])
    except ScenarioError as error:
        for option, (key, _) in given.items():
            if str(error).startswith(f"--set: {key}: "):
                raise ScenarioError(str(error).replace(f"--set: {key}", option, 1)) from None
        raise


def _recorders(options: argparse.Namespace) -> list[Observer]:
    recorders: list[Observer] = [recording.BagWriter(options.bag)] if options.bag else []
    recorders += [recording.McapWriter(options.mcap, localized=True)] if options.mcap else []
    if options.out:
        # mission.json is written last: if it exists, the rest is complete.
        recorders += [TumWriter(options.out / TRAJECTORIES), ResultWriter(options.out)]
    return recorders
