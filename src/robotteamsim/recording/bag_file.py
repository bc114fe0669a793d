"""Bags as files for rosbags, which believes every length that a file claims."""

from __future__ import annotations

import io
from pathlib import Path, PurePath
from typing import Any, BinaryIO
from urllib.parse import quote

from rosbags.interfaces.typing import StatResult

from robotteamsim.user_files import open_regular


class DamagedFileError(Exception):
    """A file claims more than it contains."""


class BagFile:
    """The path of a bag, with the methods that rosbags' readers use; they read it through `CheckedReader`."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self.stem, self.suffix = path.stem, path.suffix

    def __str__(self) -> str:
        return quote(str(self._path))  # rosbags opens files of SQLite by URI, with # and ? as they are

    def __truediv__(self, key: BagFile | PurePath | str) -> BagFile:
        return BagFile(self._path / str(key))

    def exists(self) -> bool:
        """See `Path`."""
        return self._path.exists()

    def is_dir(self) -> bool:
        """See `Path`."""
        return self._path.is_dir()

    def stat(self, *, follow_symlinks: bool = True) -> StatResult:
        """See `Path`."""
        return self._path.stat(follow_symlinks=follow_symlinks)

    def read_text(self, encoding: str | None = None) -> str:
        """See `Path`."""
        with open_regular(self._path) as file:
            return file.read().decode(encoding or "utf-8")

    def open(self, *_: Any, **__: Any) -> BinaryIO:
        """Open the file for reading in binary. Raises: OSError."""
        file = open_regular(self._path)
        if self.suffix == ".zstd":  # is read in blocks, which may end after the file
            return file
        return CheckedReader(file.detach(), self.stat().st_size)


class CheckedReader(io.BufferedReader):
    """A file that is not asked for more than it has left: the memory for it would be allocated first."""

    def __init__(self, file: io.RawIOBase, size: int) -> None:
        super().__init__(file)
        self._size = size

    def read(self, size: int | None = -1, /) -> bytes:
        """See `BufferedReader`. Raises: DamagedFileError: so many bytes are not left."""
        place = self.tell()
        left = max(self._size - place, 0)
        if size is not None and size > left:
            raise DamagedFileError(f"{size} bytes are claimed at byte {place}, but {left} are left")
        return super().read(size)
