"""Writes files atomically: an incomplete file never has the name of a result."""

import contextlib
import itertools
import os
import sys
import tempfile
import weakref
from collections.abc import Iterator, Sequence
from pathlib import Path

from robotteamsim.errors import RecordingError

if sys.platform != "win32":
    import fcntl

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
    """Write a text file atomically. Raises: RecordingError."""
    with atomically(path) as part:
        part.write_text(text, encoding="utf-8")


def cannot_write(path: Path, error: OSError) -> RecordingError:
    """Return the error that names the file that cannot be written, and the reason."""
    return RecordingError(f"{path}: cannot be written: {error.strerror or error}")


class ActiveLock:
    """Keeps other programs from recording to the same path; it ends with the process at the latest."""

    def __init__(self, path: Path, active: Path) -> None:
        """Lock what is written to before it becomes `path`; file systems without locks are none the worse.

        Args: active: a file or folder.
        Raises: OSError. RecordingError: another program has locked it.
        """
        held = contextlib.ExitStack()
        self.close = weakref.finalize(self, held.close)
        """Let others record; also happens when nobody refers to the lock any more."""
        if sys.platform != "win32":  # where nobody can delete what is open
            descriptor = os.open(active, os.O_RDONLY)
            held.callback(os.close, descriptor)
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                self.close()
                raise taken(path, active) from None
            except OSError:  # no locks here
                return


def taken(path: Path, active: Path) -> RecordingError:
    """Return the error of two programs that record to `path` at once: the other one has made `active`."""
    return RecordingError(f"{path}: cannot be written: another program writes {active}")
