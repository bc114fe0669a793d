"""Writes files atomically: an incomplete file never has the name of a result."""

import contextlib
import itertools
import os
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from robotteamsim.errors import RecordingError

PART = ".part-"
"""Begin of the names of incomplete files; a killed process leaves them."""


def prepare_folder(folder: Path) -> list[Path]:
    """Create a folder and its parents, and check that it is writable.

    Returns: the folders that did not exist, innermost first.
    Raises: RecordingError: it is not writable.
    """
    try:
        created = make_folder(folder)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise cannot_write(folder, error) from error
    return created


def make_folder(folder: Path) -> list[Path]:
    """Create a folder and its parents; return those that did not exist, innermost first. Raises: OSError."""
    created = [path for path in (folder, *folder.parents) if not path.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    return created


def remove_empty(folders: Sequence[Path]) -> None:
    """Remove folders that `make_folder` has created, unless something is in them."""
    for folder in folders:
        with contextlib.suppress(OSError):
            folder.rmdir()


def check_replaceable(path: Path) -> None:
    """Check that a path is a file or does not exist. Raises: RecordingError: it is a folder, a device or a link.

    A link would be replaced, not its target: that of a device, such as /dev/stdout, is missed by every program.
    """
    if path.is_symlink():
        raise RecordingError(f"{path}: cannot be written: is a link, expected the name of the file itself")
    if path.is_dir():
        raise RecordingError(f"{path}: cannot be written: is a folder, expected a file name")
    if path.exists() and not path.is_file():
        raise RecordingError(f"{path}: cannot be written: is a device, expected a file name")


@contextlib.contextmanager
def atomically(path: Path) -> Iterator[Path]:
    """Yield a temporary path to write to; it is renamed to `path` after the block, or deleted after an error.

    Other processes see either the old file or the complete new one. Raises: RecordingError: writing or renaming fails.
    """
    check_replaceable(path)
    # A file of that name, such as a user's own, is not touched.
    names = (f"{PART}{number}{path.name}" for number in itertools.chain([""], map("{}-".format, itertools.count(1))))
    part = next(free for name in names if not os.path.lexists(free := path.with_name(name)))
    try:
        yield part
        rename_complete(part, path)
    except BaseException as error:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)
        if isinstance(error, OSError):
            raise cannot_write(path, error) from error
        raise


def rename_complete(part: Path, path: Path) -> None:
    """Give a complete file its final name once its contents are on the disk.

    A loss of power then leaves the earlier file or the complete new one, and never the new name of half a file.

    Raises: OSError: syncing or renaming fails.
    """
    with part.open("r+b") as file:  # for reading only, Windows cannot sync
        os.fsync(file.fileno())
    part.replace(path)
    if sys.platform == "win32":  # no folder can be opened
        return
    # Some network file systems cannot sync a folder.
    with contextlib.suppress(OSError):
        folder = os.open(path.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


def write_atomically(path: Path, content: str | bytes) -> None:
    """Write a file atomically, texts in UTF-8. Raises: RecordingError."""
    with atomically(path) as part:
        if isinstance(content, bytes):
            part.write_bytes(content)
        else:
            part.write_text(content, encoding="utf-8")


def cannot_write(path: Path, error: OSError) -> RecordingError:
    """Return the error that names the file that cannot be written, and the reason."""
    return RecordingError(f"{path}: cannot be written: {error.strerror or error}")


def lock_active(descriptor: int, path: Path, active: Path) -> None:
    """Keep other programs from recording to `path` until the descriptor of an open file `active` is closed.

    Where a file system has no locks, nothing keeps them off. Raises: RecordingError: another program writes `active`.
    """
    if sys.platform == "win32":  # nobody can delete what is open
        return
    import fcntl  # only POSIX has it

    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        is_there = os.path.samestat(os.fstat(descriptor), os.stat(active))
    except (BlockingIOError, FileNotFoundError):
        is_there = False
    except OSError:  # no locks
        return
    if not is_there:
        raise taken(path, active)


def taken(path: Path, active: Path) -> RecordingError:
    """Return the error of two programs that record to `path` at once: the other one has made `active`."""
    return RecordingError(f"{path}: cannot be written: another program writes {active}")
