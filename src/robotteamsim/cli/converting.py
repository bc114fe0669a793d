"""What the commands share that convert floor plans and worlds."""

import argparse
import os
import sys
from collections.abc import Iterable
from pathlib import Path

from robotteamsim.cli.parser import SCENARIO_HELP, UsageError, path_of
from robotteamsim.cli.run_command import add_set_option


def add_export_options(parser: argparse.ArgumentParser, written: str) -> None:
    """Add the scenario to export and the folder to write; `written`: what it will contain, for the help."""
    parser.add_argument("scenario", metavar="SCENARIO", help=SCENARIO_HELP)
    add_set_option(parser)
    parser.add_argument("--out", type=path_of, required=True, metavar="DIR", help=f"where to write {written}")


def add_plan_option(parser: argparse.ArgumentParser) -> None:
    """Add the file of an imported floor plan."""
    parser.add_argument(
        "--out", type=path_of, metavar="FILE", help="the floor plan to write; default plan.yaml, if that does not exist"
    )


def plan_file(out: Path | None, source: Path, kind: str) -> Path:
    """Return where an imported floor plan is written.

    Args:   out: the option. kind: what the source is, for the message.
    Raises: UsageError: it would overwrite the source, or without the option another file.
    """
    path = out or Path("plan.yaml")
    if out is None and path.exists():
        raise UsageError(f"{path} already exists; choose a file with --out")
    if os.path.realpath(path) == os.path.realpath(source):
        raise UsageError(f"--out {path}: would overwrite the {kind}")
    return path


def warn(notes: Iterable[str]) -> None:
    """Print the notes of a conversion."""
    for note in notes:
        print(f"robotteamsim: warning: {note}", file=sys.stderr)
