"""What takes seconds to compute, kept in the user's cache folder by what it depends on.

The folder is `$ROBOTTEAMSIM_CACHE`, by default `robotteamsim` in `$XDG_CACHE_HOME` or `~/.cache`; if the variable is
empty, nothing is kept. The folder may be deleted at any time. Processes may share it, because a file appears there
complete or not at all. Without a usable folder, results are the same and only take longer.
"""

from __future__ import annotations

import hashlib
import importlib.machinery
import importlib.metadata
import os
import tempfile
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path

import robotteamsim
from robotteamsim.user_files import open_regular

_LIBRARIES = ("numpy", "opencv-python-headless", "scipy", "shapely")
_DIGEST_BYTES = hashlib.sha256().digest_size


def cached(content: Iterable[bytes], make: Callable[[], bytes]) -> bytes:
    """Return what `make` returns, or returned before in any process for the same content.

    Args: content: everything that the result depends on, besides the code of this package and its libraries.
    """
    folder = _folder()
    if folder is None:
        return make()
    key = hashlib.sha256(_code())
    for part in content:
        key.update(b"%d:" % len(part) + part)
    file = folder / key.hexdigest()
    try:
        with open_regular(file) as opened:
            digest, kept = opened.read(_DIGEST_BYTES), opened.read()
        if digest == hashlib.sha256(kept).digest():
            return kept
    except (OSError, ValueError):  # missing or unreadable
        pass
    made = make()
    _store(file, hashlib.sha256(made).digest() + made)
    return made


@cache
def _code() -> bytes:
    """Return a digest of the package's code, Python and compiled, and of the libraries that results depend on."""
    digest = hashlib.sha256()
    endings = tuple(importlib.machinery.SOURCE_SUFFIXES + importlib.machinery.EXTENSION_SUFFIXES)
    for folder in robotteamsim.__path__:
        for file in sorted(Path(folder).rglob("*")):
            if file.name.endswith(endings):
                digest.update(file.read_bytes())
    for name in _LIBRARIES:
        try:
            digest.update(f"{name} {importlib.metadata.version(name)}".encode())
        except importlib.metadata.PackageNotFoundError:
            continue
    return digest.digest()


def _folder() -> Path | None:
    given = os.environ.get("ROBOTTEAMSIM_CACHE")
    if given is not None:
        return Path(given) if given else None
    base = os.environ.get("XDG_CACHE_HOME", "")  # a relative one does not count, by its specification
    return Path(base if os.path.isabs(base) else os.path.expanduser("~/.cache")) / "robotteamsim"


def _store(file: Path, data: bytes) -> None:
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        handle, part = tempfile.mkstemp(dir=file.parent)
        try:
            with os.fdopen(handle, "wb") as opened:
                opened.write(data)
            os.replace(part, file)
        except OSError:
            os.unlink(part)
    except OSError:  # a full or read-only disk
        return
