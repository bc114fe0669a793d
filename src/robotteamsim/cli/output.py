"""What commands write: tables, warnings, pictures and other files."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from rich.console import Console

from robotteamsim.cli.parser import PICTURES, UsageError, picture_of
from robotteamsim.errors import RobotTeamSimError
from robotteamsim.recording.files import check_replaceable
from robotteamsim.wording import printable

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class OutputConsole(Console):
    """Leaves a closed pipe to `main`, which has a status for it; rich would end with 1."""

    def on_broken_pipe(self) -> NoReturn:
        """Raises: BrokenPipeError."""
        raise BrokenPipeError


def add_png_option(parser: argparse.ArgumentParser, text: str = "the picture to write", required: bool = True) -> None:
    """Add --png, also for PDF and SVG. Args: text: its help."""
    kinds = f"{', '.join(PICTURES[:-1])} or {PICTURES[-1]}"
    parser.add_argument("--png", type=picture_of, required=required, metavar="FILE", help=f"{text}: {kinds}")


def check_outputs(
    outputs: Mapping[str, Path | None],
    inputs: Iterable[str | Path],
    *,
    folders: Mapping[str, Sequence[Path]] | None = None,
) -> None:
    """Check that files can be written, and over neither an input nor each other; call this before writing any.

    Args:   outputs: by option; None if it is not given.
            inputs: files that the command reads.
            folders: the files that it writes into folders, which it creates, by option.
    Raises: UsageError, RecordingError.
    """
    of_folders = [(option, file) for option, files in (folders or {}).items() for file in files]
    created = [file.parent for _, file in of_folders]
    used = {os.path.realpath(file): "a file that this command reads" for file in inputs}
    for option, path in (*of_folders, *outputs.items()):
        if path is None:
            continue
        check_replaceable(path)
        if path.parent not in created and not path.parent.is_dir():
            raise UsageError(f"{path}: cannot be written: {path.parent} is not a folder")
        file = os.path.realpath(path)
        if file in used:
            raise UsageError(f"{option} {path}: would overwrite {used[file]}; choose another file")
        used[file] = f"the file of {option}"


def expect_new(paths: Iterable[Path], force: bool) -> None:
    """Raises: UsageError: something exists and may not be replaced."""
    for path in paths:
        if path.exists() and not force:
            raise UsageError(f"{path} already exists; choose another name with --out, or --force replaces it")


def warn(notes: Iterable[str]) -> None:
    """Print the notes of a conversion."""
    for note in notes:
        print(f"robotteamsim: warning: {note}", file=sys.stderr)


def mistakes_of(error: RobotTeamSimError) -> list[str]:
    """Return the mistakes that an error names."""
    return [str(error), *getattr(error, "__notes__", [])]


def report_mistakes(mistakes: Sequence[str]) -> None:
    """Report mistakes, in several files or in one. Raises: UsageError: the last one, if there is one."""
    for mistake in mistakes[:-1]:
        print(f"robotteamsim: {printable(mistake)}", file=sys.stderr)
    if mistakes:
        raise UsageError(mistakes[-1])


def save(figure: Figure, path: Path) -> None:
    """Write a picture and print its path. Raises: RecordingError."""
    from robotteamsim.analysis.figure_files import write_figure  # Matplotlib is an extra, and slow to import.

    write_figure(figure, path)
    print(path)
