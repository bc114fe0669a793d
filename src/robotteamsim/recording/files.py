"""Writing files so that nothing half-written is ever left behind under a result's name."""

from __future__ import annotations

import contextlib
import os
import tempfile
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


def write_atomically(path: Path, text: str) -> None:
    """Write a file in one go: others see the old file or the whole new one. Raises: RecordingError."""
    part = path.with_name(f".{path.name}.part")
    try:
        with part.open("w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        part.replace(path)
    except OSError as error:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)
        raise cannot_write(path, error) from error


def cannot_write(path: Path, error: OSError) -> RecordingError:
    """Return the error that tells a user which file could not be written, and why."""
    return RecordingError(f"{path}: cannot be written: {error.strerror or error}")
