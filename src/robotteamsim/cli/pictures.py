"""Shared parts of the commands that write pictures."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from robotteamsim.cli.parser import path_of
from robotteamsim.recording.files import atomically

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def add_png_option(parser: argparse.ArgumentParser) -> None:
    """Add --png."""
    parser.add_argument("--png", type=path_of, required=True, metavar="FILE", help="the picture to write")


def save(figure: Figure, path: Path) -> None:
    """Write a picture and print its path. Raises: RecordingError."""
    with atomically(path) as part:
        figure.savefig(part, format="png")
    print(path)
