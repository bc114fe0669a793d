"""`robotteamsim benchmark`: compare controllers under one protocol, and report them with a lower bound."""

from __future__ import annotations

import argparse
import dataclasses
import importlib
import json
import shutil
import sys
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.progress import track

from robotteamsim.arguments import number, positive_number, positive_whole_number, whole_number
from robotteamsim.campaign import Design, Outcome
from robotteamsim.campaign import protocol as protocols
from robotteamsim.campaign.summary import UNLIMITED, aligned
from robotteamsim.cli.campaign_command import add_worker_options, command_line, run_stored
from robotteamsim.cli.parser import Parser, UsageError, folder_of, path_of
from robotteamsim.cli.run_command import SCENARIO_HELP
from robotteamsim.scenario.controllers import is_policy_file
from robotteamsim.wording import printable

if TYPE_CHECKING:
    from robotteamsim.analysis.report import Report

_SEARCH = """\
Compare controllers in searches for victims at random places: all controllers have the
same victims, voices and sensor noise. The report has intervals, tests with Holm's
correction, performance profiles, and a lower bound: the time of a team that knows where
the victims are. Without options, a small protocol (--quick) runs within a minute on two
cores. docs/benchmark.md describes the protocols, the bound and its proof."""

_SEARCH_EPILOG = """\
A controller is rdpso_published, rdpso_adapted, a name of control.algorithm, or
module:Class. The first one is the reference of all comparisons. --policy adds a learned
policy, policy.pt or module:Class, to the controllers. The same command resumes a
benchmark that was stopped.

examples:
  robotteamsim benchmark search --out DIR
  robotteamsim benchmark search --full --out DIR --scheduler tcp://head:8786
  robotteamsim benchmark search --policy policy.pt --out DIR
  robotteamsim benchmark search --controller greedy --controller my_package:Mine \\
      --building garage --building my.yaml --noise 30 --robots 4 --trials 20 --out DIR"""

_PATROL = """\
Compare controllers that patrol a graph by its idleness: mean, greatest, and of each
vertex, with intervals and tests with Holm's correction."""

_PATROL_EPILOG = """\
--graph reads the format of patrolling_sim. The same command resumes a benchmark that
was stopped.

examples:
  robotteamsim benchmark patrol --out DIR
  robotteamsim benchmark patrol --building cumberland.yaml --graph cumberland.graph --full --out DIR"""

_EXPLORATION = """\
Compare controllers that explore buildings that they do not know: when 90 and 99 % of the
floor are known, how right the maps are, and how many bytes robots send."""

_EXPLORATION_EPILOG = """\
A controller is a name of docs/benchmark.md, a name of control.algorithm with which
control.map may be unknown, or module:Class. The first one is the reference of all
comparisons. The same command resumes a benchmark that was stopped.

examples:
  robotteamsim benchmark exploration --out DIR
  robotteamsim benchmark exploration --building rooms --robots 4 --controller frontier \\
      --controller my_package:Mine --trials 20 --out DIR"""


def add_to(parser: Parser) -> None:
    """Describe the command to its parser."""
    kinds = parser.add_subparsers(title="benchmarks", metavar="search|patrol|exploration", required=True)
    for kind in (_add_search(kinds), _add_patrol(kinds), _add_exploration(kinds)):
        kind.add_argument("--out", type=folder_of, required=True, metavar="DIR", help="folder of missions and report")
        size = kind.add_mutually_exclusive_group()
        size.add_argument("--quick", action="store_true", help="the small protocol, which is the default")
        size.add_argument("--full", action="store_true", help="the full protocol; see docs/benchmark.md for its time")
        kind.add_argument(
            "--controller", action="append", metavar="NAME", help="a controller instead of the protocol's; repeatable"
        )
        kind.add_argument(
            "--robots", type=positive_whole_number, action="append", metavar="N", help="number of robots; repeatable"
        )
        kind.add_argument("--trials", type=whole_number, metavar="N", help="missions of each cell")
        kind.add_argument("--seed", type=whole_number, metavar="N", help="seed of the benchmark; default 1")
        add_worker_options(kind)
        kind.add_argument("--json", action="store_true", help="print the tables as one JSON object")
        kind.add_argument("--quiet", action="store_true", help="no progress, no tables")


def _add_search(kinds: Any) -> Parser:
    search: Parser = kinds.add_parser(
        "search", help="searches for random victims", description=_SEARCH, epilog=_SEARCH_EPILOG
    )
    names = ", ".join(protocols.BUILDINGS)
    search.add_argument("--building", action="append", metavar="NAME", help=f"{names}; or {SCENARIO_HELP}; repeatable")
    search.add_argument("--noise", type=number, action="append", metavar="DB", help="background noise [dB]; repeatable")
    search.add_argument(
        "--policy",
        action="append",
        default=[],
        metavar="POLICY",
        help="another controller to compare, a policy; repeatable",
    )
    search.add_argument("--victims", type=whole_number, metavar="N", help="victims in each mission; default 4")
    search.add_argument("--no-areas", action="store_true", help="no areas to explore: the last one ends a mission")
    search.set_defaults(command=run_search)
    return search


def _add_patrol(kinds: Any) -> Parser:
    patrol: Parser = kinds.add_parser("patrol", help="patrols of a graph", description=_PATROL, epilog=_PATROL_EPILOG)
    names = ", ".join(protocols.BUILDINGS)
    patrol.add_argument("--building", default="garage", metavar="NAME", help=f"{names}; or {SCENARIO_HELP}")
    patrol.add_argument(
        "--graph", type=path_of, metavar="FILE", help="a .graph file of patrolling_sim; default a lattice of places"
    )
    patrol.add_argument("--duration", type=positive_number, metavar="S", help="length of each mission [s]")
    patrol.set_defaults(command=run_patrol)
    return patrol


def _add_exploration(kinds: Any) -> Parser:
    explore: Parser = kinds.add_parser(
        "exploration", help="explorations of unknown buildings", description=_EXPLORATION, epilog=_EXPLORATION_EPILOG
    )
    names = ", ".join(protocols.UNKNOWN_BUILDINGS)
    explore.add_argument("--building", action="append", metavar="NAME", help=f"{names}; or {SCENARIO_HELP}; repeatable")
    explore.add_argument(
        "--start", action="append", metavar="near|far", help="robots start together or anywhere; repeatable"
    )
    explore.add_argument(
        "--pose",
        action="append",
        metavar="known|unknown|unknown_start",
        help="robots know their true poses, or their starts, or neither; repeatable",
    )
    explore.add_argument("--duration", type=positive_number, metavar="S", help="time limit of each mission [s]")
    explore.set_defaults(command=run_exploration)
    return explore


def run_search(options: argparse.Namespace) -> int:
    """Run a search benchmark. Returns: 0, or 1 if missions failed or were given up, or a controller failed in one."""
    base = protocols.full_search() if options.full else protocols.quick_search()
    for policy in options.policy:
        if ":" not in policy and not is_policy_file(policy):
            raise UsageError(f"--policy: '{policy}'; expected a file .pt or .pt2, or module:Class")
    protocol = dataclasses.replace(
        base,
        **_given(
            controllers=(*(options.controller or base.controllers), *options.policy),
            buildings=options.building,
            noises_db=options.noise,
            robots=options.robots,
            trials=options.trials,
            victims=options.victims,
            seed=options.seed,
        ),
        areas=not options.no_areas,
    )
    design = protocols.search_design(protocol)
    command = command_line(
        ["benchmark", "search"],
        {
            "--controller": protocol.controllers,
            "--building": protocol.buildings,
            "--noise": [f"{noise_db:g}" for noise_db in protocol.noises_db],
            "--robots": protocol.robots,
            "--trials": [protocol.trials],
            "--victims": [protocol.victims],
            "--seed": [protocol.seed],
        },
        *(() if protocol.areas else ("--no-areas",)),
    )

    def report(outcomes: tuple[Outcome, ...]) -> Report:
        from robotteamsim.analysis.benchmark.measures import lower_bounds
        from robotteamsim.analysis.benchmark.report import make_search_report

        console = Console(stderr=True, quiet=options.quiet)
        shown = partial(
            track, description="lower bounds", console=console, disable=not console.is_terminal, transient=True
        )
        return make_search_report(design, outcomes, command, lower_bounds(design, outcomes, shown))

    return _run(options, design, command, "benchmark search", report)


def run_patrol(options: argparse.Namespace) -> int:
    """Run a patrol benchmark. Returns: 0, or 1 if missions failed or were given up, or a controller failed in one."""
    graph = None if options.graph is None else str(options.graph.absolute())
    make = protocols.full_patrol if options.full else protocols.quick_patrol
    given = _given(
        controllers=options.controller,
        robots=options.robots,
        trials=options.trials,
        duration_s=options.duration,
        seed=options.seed,
    )
    protocol = dataclasses.replace(make(options.building, graph), **given)
    design = protocols.patrol_design(protocol)
    command = command_line(
        ["benchmark", "patrol"],
        {
            "--building": [protocol.building],
            "--graph": [] if protocol.graph is None else [protocol.graph],
            "--controller": protocol.controllers,
            "--robots": protocol.robots,
            "--trials": [protocol.trials],
            "--duration": [f"{protocol.duration_s:g}"],
            "--seed": [protocol.seed],
        },
    )

    def report(outcomes: tuple[Outcome, ...]) -> Report:
        from robotteamsim.analysis.benchmark.report import make_patrol_report

        return make_patrol_report(design, outcomes, command)

    return _run(options, design, command, "benchmark patrol", report)


def run_exploration(options: argparse.Namespace) -> int:
    """Run an exploration benchmark. Returns: 0, or 1 if missions failed or were given up, or a controller failed."""
    protocol = dataclasses.replace(
        protocols.full_exploration() if options.full else protocols.quick_exploration(),
        **_given(
            controllers=options.controller,
            buildings=options.building,
            robots=options.robots,
            starts=options.start,
            poses=options.pose,
            trials=options.trials,
            duration_s=options.duration,
            seed=options.seed,
        ),
    )
    design = protocols.exploration_design(protocol)
    command = command_line(
        ["benchmark", "exploration"],
        {
            "--controller": protocol.controllers,
            "--building": protocol.buildings,
            "--start": protocol.starts,
            "--pose": protocol.poses,
            "--robots": protocol.robots,
            "--trials": [protocol.trials],
            "--duration": [f"{protocol.duration_s:g}"],
            "--seed": [protocol.seed],
        },
    )

    def report(outcomes: tuple[Outcome, ...]) -> Report:
        from robotteamsim.analysis.benchmark.report import make_exploration_report

        return make_exploration_report(design, outcomes, command)

    return _run(options, design, command, "benchmark exploration", report)


def _given(**values: Any) -> dict[str, Any]:
    """Return the options that were given; lists as tuples."""
    return {
        name: tuple(value) if isinstance(value, list) else value for name, value in values.items() if value is not None
    }


def _run(
    options: argparse.Namespace,
    design: Design,
    command: str,
    name: str,
    report: Callable[[tuple[Outcome, ...]], Report],
) -> int:
    # Imported late, because Matplotlib and statsmodels are slow to load, but before the first mission, in case one is
    # missing.
    importlib.import_module("robotteamsim.analysis.benchmark.report")
    ran = run_stored(options, design, command, name)
    ran.warn()
    made = report(ran.outcomes)
    path = made.write(options.out)
    if options.json:
        rows = {t.name: [dict(zip(t.head, row, strict=True)) for row in t.texts] for t in made.tables}
        failed = sum(bool(outcome.controller_failed) for outcome in ran.outcomes)
        document = {"report": str(path), "notes": made.notes, "controllers_failed": failed, "tables": rows}
        print(json.dumps(document, ensure_ascii=False))
    elif not options.quiet:
        _print_report(made)
        print(f"\nwritten {path}")
    return ran.status


def _print_report(made: Report) -> None:
    """Print the notes and the first table."""
    for note in made.notes:
        print(printable(note))
    first = made.tables[0]
    width = shutil.get_terminal_size().columns if sys.stdout.isatty() else UNLIMITED
    print(f"{first.title}\n\n{aligned([first.head, *first.texts], first.left, width)}")
