"""`robotteamsim campaign`: run many missions on many processes and print tables of their results."""

import argparse
import contextlib
import importlib
import json
import shlex
import shutil
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from rich.console import Console

from robotteamsim.arguments import number, positive_whole_number, whole_number
from robotteamsim.campaign import Design, Outcome, Store, check_folder, make_design, open_store
from robotteamsim.campaign.cluster import scheduler_at
from robotteamsim.campaign.design import NOISE_KEY, Trial
from robotteamsim.campaign.factors import DesignFile, Factor, parse_override, parse_sweep, read_design_file
from robotteamsim.campaign.summary import (
    UNLIMITED,
    controllers_note,
    copies_note,
    exclusion_note,
    summarise,
    summary_table,
)
from robotteamsim.campaign.workers import Workers, local_workers
from robotteamsim.cli.parser import Parser, address, path_of
from robotteamsim.cli.progress import CampaignProgress
from robotteamsim.cli.run_command import SCENARIO_HELP, add_code_option, add_set_option
from robotteamsim.wording import printable

DEFAULT_TRIALS = 30
DEFAULT_SEED = 1
EXIT_INCOMPLETE = 1
_MAX_LISTED_FAILURES = 10
_SHOWN_OF_ERROR = 100
"""Letters of the begin of a long error, and of its end, which names the line of code."""

DESCRIPTION = """\
Run many missions on all cores and print tables of their results. Each result is stored
in DIR as soon as its mission ends. If a campaign is stopped or killed, the same command
resumes it. The results do not depend on the number of workers."""

EPILOG = """\
DIR receives campaign.sqlite, which contains everything, and trials.csv. The table at the end
has one line per cell; `robotteamsim report DIR` makes figures and tables for a paper.

examples:
  robotteamsim campaign garage_sar --noise 10 --noise 20 --noise 30 --trials 30 --out DIR
  robotteamsim campaign garage_sar --sweep control.alpha=0.3,0.5,0.7 --trials 100 --out DIR
  robotteamsim campaign my.yaml --design design.yaml --out DIR --scheduler tcp://head:8786"""


def add_to(parser: Parser) -> None:
    """Describe the command to its parser."""
    parser.add_argument("scenario", metavar="SCENARIO", help=SCENARIO_HELP)
    parser.add_argument("--out", type=path_of, required=True, metavar="DIR", help="folder of the campaign")
    parser.add_argument(
        "--noise", type=number, action="append", metavar="DB", help="a background noise [dB]; repeatable"
    )
    parser.add_argument(
        "--sweep",
        action="append",
        default=[],
        metavar="K=A,B,C",
        help="values of a scenario key; repeatable: all combinations are run",
    )
    parser.add_argument("--design", type=path_of, metavar="FILE", help="YAML: trials, seed, paired, set, sweep, cells")
    parser.add_argument("--trials", type=whole_number, metavar="N", help=f"trials per cell; default {DEFAULT_TRIALS}")
    parser.add_argument(
        "--seed",
        type=whole_number,
        metavar="N",
        help=f"seed of the campaign, which determines the seeds of all trials; default {DEFAULT_SEED}",
    )
    parser.add_argument(
        "--paired",
        action="store_true",
        help="trials of equal number have the same seed in all cells; the report then compares them in pairs",
    )
    add_set_option(parser)
    add_code_option(parser)
    add_worker_options(parser)
    parser.add_argument("--json", action="store_true", help="print a summary as one JSON object instead of tables")
    parser.add_argument("--quiet", action="store_true", help="no progress, no tables")
    parser.set_defaults(command=run)


def add_worker_options(parser: argparse.ArgumentParser) -> None:
    """Add --workers and --scheduler."""
    places = parser.add_mutually_exclusive_group()
    places.add_argument(
        "--workers", type=positive_whole_number, metavar="N", help="number of processes; default one per core"
    )
    places.add_argument(
        "--scheduler", type=address, metavar="ADDRESS", help="scheduler of a Dask cluster, such as tcp://10.0.0.1:8786"
    )


def run(options: argparse.Namespace) -> int:
    """Run the campaign. Returns: 0, or 1 if trials failed or were given up, or a controller failed in one."""
    design = _design(options)
    named = {
        "--noise": [f"{noise_db:g}" for noise_db in options.noise or ()],
        "--sweep": options.sweep,
        "--set": options.overrides,
        "--design": [options.design] if options.design else [],
        "--trials": [design.trials],
        "--seed": [design.seed],
    }
    command = command_line(["campaign", options.scenario], named, *(["--paired"] if design.paired else []))
    ran = run_stored(options, design, command, design.scenario.name)
    if options.json:
        stopped = [outcome for outcome in ran.outcomes if outcome.controller_failed]
        given_up = [{"cell": trial.cell, "trial": trial.number, "seed": trial.seed} for trial in ran.given_up]
        document = {
            "scenario": design.scenario.name,
            "seed": design.seed,
            "trials": design.trials,
            "cells": [asdict(summary) for summary in summarise(design, ran.outcomes)],
            "failed": [{"cell": o.cell, "trial": o.number, "seed": o.seed, "error": o.error} for o in ran.failed],
            "controllers_failed": len(stopped),
            "with_failed_controllers": [
                {"cell": o.cell, "trial": o.number, "seed": o.seed, "controller_failed": o.controller_failed}
                for o in stopped
            ],
            "given_up": given_up,
            "folder": str(options.out),
            "csv": str(ran.csv_path),
        }
        print(json.dumps(document))
    elif not options.quiet:
        _print_tables(design, ran.outcomes)
        print(f"\nwritten {ran.csv_path}")
    ran.warn()
    return ran.status


@dataclass(frozen=True, slots=True)
class StoredRun:
    """The missions of a campaign that is stored. given_up: trials that killed their workers."""

    outcomes: tuple[Outcome, ...]
    given_up: tuple[Trial, ...]
    csv_path: Path

    @property
    def failed(self) -> list[Outcome]:
        """Those that failed."""
        return [outcome for outcome in self.outcomes if outcome.failed]

    @property
    def status(self) -> int:
        """The exit status: 0, or 1 if trials failed or were given up, or a controller failed in one."""
        return EXIT_INCOMPLETE if self.failed or self.given_up or controllers_note(self.outcomes) else 0

    def warn(self) -> None:
        """Print one line for each trial that failed or was given up, up to a limit, and one for failed controllers."""
        for outcome in self.failed[:_MAX_LISTED_FAILURES]:
            error = outcome.error
            if len(error) > 2 * _SHOWN_OF_ERROR:
                error = f"{error[:_SHOWN_OF_ERROR]} ... {error[-_SHOWN_OF_ERROR:]}"
            _warn(printable(f"trial {outcome.number} of cell {outcome.cell} (seed {outcome.seed}) failed: {error}"))
        if len(self.failed) > _MAX_LISTED_FAILURES:
            _warn(f"{len(self.failed) - _MAX_LISTED_FAILURES} more trials failed; {self.csv_path} lists them")
        for trial in self.given_up:
            _warn(f"trial {trial.number} of cell {trial.cell} (seed {trial.seed}) killed its workers; not stored")
        if note := controllers_note(self.outcomes):
            _warn(printable(note))


def run_stored(options: argparse.Namespace, design: Design, command: str, name: str) -> StoredRun:
    """Run the missing trials of a design in its folder, and show progress under a name.

    Args: options: with out, quiet, scheduler and workers.  command: see `command_line`.
    """
    importlib.import_module("scipy")  # of the tables, after all trials
    check_folder(options.out, design)
    if options.scheduler and not _is_protected(options.scheduler):
        _warn(f"warning: {options.scheduler}: without TLS, whoever reaches it can run code; see docs/experiments.md")
    with contextlib.ExitStack() as stack:
        # Connect first, so that a scheduler that does not answer leaves no store behind.
        cluster = stack.enter_context(scheduler_at(options.scheduler)) if options.scheduler else None
        store = stack.enter_context(open_store(options.out, design, command))
        given_up = _run_missing(options, design, store, cluster, name)
        return StoredRun(store.outcomes(), given_up, store.export())


def command_line(words: Sequence[str], options: Mapping[str, Iterable[object]], *flags: str) -> str:
    """Return the command line that runs a campaign in a folder DIR. Args: options: with each of their values."""
    named = [word for option, values in options.items() for value in values for word in (option, str(value))]
    return shlex.join(["robotteamsim", *words, *named, *flags, "--out", "DIR"])


def _design(options: argparse.Namespace) -> Design:
    file, place = (read_design_file(options.design), str(options.design)) if options.design else (DesignFile(), "")
    noise = [Factor(NOISE_KEY, tuple(options.noise), "--noise")] if options.noise else []
    return make_design(
        options.scenario,
        trials=_first(options.trials, file.trials, DEFAULT_TRIALS),
        seed=_first(options.seed, file.seed, DEFAULT_SEED),
        overrides=[
            *(Factor(key, (value,), place) for key, value in file.overrides.items()),
            *map(parse_override, options.overrides),
        ],
        factors=[
            *noise,
            *(Factor(key, values, place) for key, values in file.sweep.items()),
            *map(parse_sweep, options.sweep),
        ],
        allow_code=options.allow_code,
        groups=[[Factor(key, (value,), place) for key, value in cell.items()] for cell in file.cells or ({},)],
        paired=options.paired or bool(file.paired),
    )


def _run_missing(
    options: argparse.Namespace, design: Design, store: Store, cluster: Workers | None, name: str
) -> tuple[Trial, ...]:
    """Return the trials that were given up. Args: cluster: None: workers on this machine."""
    missing = store.missing()
    if not missing:
        return ()
    total = len(design.cells) * design.trials
    console = Console(stderr=True, quiet=options.quiet)
    try:
        with contextlib.ExitStack() as stack:
            progress = CampaignProgress(console, name, total, total - len(missing))
            stack.enter_context(progress)
            if cluster and not cluster.count:
                progress.print_line(f"{options.scheduler} has no workers yet; missions start when workers connect")
            workers = cluster or stack.enter_context(local_workers(options.workers, len(missing)))

            def keep(outcome: Outcome) -> None:
                store.keep(outcome)
                progress.add(outcome)

            given_up = workers.run(design, missing, keep)
            progress.finish()
            return given_up
    except KeyboardInterrupt:
        left = len(store.missing())
        _warn(f"{total - left} of {total} trials are stored in {options.out}; run the same command to resume")
        raise


def _print_tables(design: Design, outcomes: tuple[Outcome, ...]) -> None:
    width = shutil.get_terminal_size().columns if sys.stdout.isatty() else UNLIMITED
    summaries = summarise(design, outcomes)
    print(summary_table(design, summaries, width))
    counts = [(cell.name, cell.trials, cell.different) for cell in summaries]
    for note in (exclusion_note(outcomes), copies_note(counts)):
        if note:
            print(f"\n{note}")


def _first(*values: int | None) -> int:
    return next(value for value in values if value is not None)


def _is_protected(scheduler: str) -> bool:
    """Whether an address is encrypted, or of this machine alone."""
    protocol, _, place = scheduler.rpartition("://")
    return protocol in ("tls", "wss", "inproc") or place.startswith(("127.", "localhost:", "[::1]"))


def _warn(line: str) -> None:
    print(f"robotteamsim: {line}", file=sys.stderr)
