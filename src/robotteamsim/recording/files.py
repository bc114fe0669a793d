"""Writing files so that nothing half-written is ever left behind under a result's name."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

from robotteamsim.errors import RecordingError


def prepare_folder(folder: Path) -> None:
    """Make a folder, with its parents, in which files can be written. Raises: RecordingError: that is not possible."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise cannot_write(folder, error) from error


def check_replaceable(path: Path) -> None:
    """Make sure that a path names a file, or nothing yet. Raises: RecordingError: a folder, a device."""
    if path.is_dir():
        raise RecordingError(f"{path}: cannot be written: is a folder, wanted a file name")
    if path.exists() and not path.is_file():
        raise RecordingError(f"{path}: cannot be written: is a device, wanted a file name")


@contextlib.contextmanager
def atomically(path: Path) -> Iterator[Path]:
    """Give a name to write to; when the block is left, the file takes the name `path`, or vanishes after an error.

    Others see the old file or the whole new one. Raises: RecordingError: an OSError in the block, or at the renaming.
    """
    check_replaceable(path)
    part = path.with_name(f".part-{path.name}")
    try:
        yield part
        with part.open("rb") as file:
            os.fsync(file.fileno())
        part.replace(path)
    except BaseException as error:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)
        if isinstance(error, OSError):
            raise cannot_write(path, error) from error
        raise


def write_atomically(path: Path, text: str) -> None:
    """Write a text file in one go. Raises: RecordingError."""
    with atomically(path) as part:
        part.write_text(text, encoding="utf-8")


def cannot_write(path: Path, error: OSError) -> RecordingError:
    """Return the error that tells a user which file could not be written, and why."""
    return RecordingError(f"{path}: cannot be written: {error.strerror or error}")
