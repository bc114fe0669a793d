"""Imported plans in the user's cache folder, by content: the import of a large image takes seconds.

The folder is `$ROBOTTEAMSIM_CACHE`, by default `robotteamsim` in `$XDG_CACHE_HOME` or `~/.cache`; if the variable is
empty, nothing is kept. The folder may be deleted at any time. Processes may share it, because a file appears there
complete or not at all. Without a usable folder, plans are the same and only take longer.
"""

from __future__ import annotations

import hashlib
import importlib.metadata
import os
import tempfile
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path

from robotteamsim import map_import
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.user_files import open_regular

_LIBRARIES = ("numpy", "shapely", "opencv-python-headless")


def cached_plan(content: Iterable[bytes], make: Callable[[], FloorPlan]) -> FloorPlan:
    """Return what `make` returns, or returned before in any process for the same content.

    Args: content: everything that the plan depends on, besides the code of the import and its libraries.
    """
    digest = hashlib.sha256(_code())
    for part in content:
        digest.update(b"%d:" % len(part) + part)
    folder = _folder()
    if folder is None:
        return make()
    file = folder / f"{digest.hexdigest()}.json"
    try:
        with open_regular(file) as opened:
            return FloorPlan.model_validate_json(opened.read())
    except (OSError, ValueError):  # missing, unreadable or damaged
        plan = make()
    _store(file, plan.model_dump_json().encode())
    return plan


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


@cache
def _code() -> bytes:
    """Return a digest of everything that may change the import of the same image."""
    digest = hashlib.sha256()
    here = [Path(__file__).with_name(name) for name in ("image_walls.py", "map_image.py")]
    for file in (*sorted(Path(map_import.__file__).parent.glob("*.py")), *here):
        digest.update(file.read_bytes())
    for name in _LIBRARIES:
        try:
            digest.update(f"{name} {importlib.metadata.version(name)}".encode())
        except importlib.metadata.PackageNotFoundError:
            continue
    return digest.digest()
