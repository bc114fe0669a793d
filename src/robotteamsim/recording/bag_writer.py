"""Writes a ROS 1 bag of a headless run."""

import contextlib
import os
import struct
from pathlib import Path
from typing import Any

from rosbags.rosbag1 import Writer, WriterError

from robotteamsim.errors import RecordingError
from robotteamsim.recording.bag import BagMessages, BagTopic, check_size
from robotteamsim.recording.bag_types import BagTypes
from robotteamsim.recording.files import (
    cannot_write,
    check_replaceable,
    lock_active,
    make_folder,
    remove_empty,
    rename_complete,
    taken,
)
from robotteamsim.setup import Setup
from robotteamsim.simulation import Result, StepRecord
from robotteamsim.user_files import open_regular

CHUNK_BYTES = 256 * 1024
"""Size of a chunk [bytes], the most that a killed process can lose; three robots fill one in about 4 s simulated."""

_MAGIC = b"#ROSBAG V2.0\n"
_FILE_HEADER_BYTES = 4096


class _Writer(Writer):
    """A bag file whose file header has the length that ROS's own tools use.

    rosbags pads it to 8 bytes less. `rosbag reindex` rewrites the header in its own length and would then overwrite the
    start of the first chunk.
    """

    def open(self) -> None:
        """Open the file."""
        super().open()
        assert self.bio is not None
        self.bio.flush()
        self._pad_header()
        self.bio.seek(0, os.SEEK_END)

    def close(self) -> None:
        """Write the index and close the file."""
        super().close()
        self._pad_header()

    def _pad_header(self) -> None:
        with self.path.open("r+b") as file:
            file.seek(len(_MAGIC))
            (header_length,) = struct.unpack("<I", file.read(4))
            file.seek(header_length, os.SEEK_CUR)
            padding = b" " * (_FILE_HEADER_BYTES - header_length)
            file.write(struct.pack("<I", len(padding)) + padding)


class BagWriter:
    """Writes a ROS 1 bag while the trial runs.

    Like `rosbag record`, it writes to `path`.active and renames that file when the run ends or is interrupted. After a
    kill or a full disk, the .active file contains all complete chunks; `rosbag reindex` makes it readable.
    """

    def __init__(self, path: Path, *, localized: bool = False) -> None:
        """Args: localized: whether /tf also has map -> odom of each robot, as with `localization:=ground_truth`."""
        self._path, self._localized = path, localized
        self._active = path.parent / f"{path.name}.active"
        self._writer: _Writer | None = None
        self._created: list[Path] = []
        self._steps = 0
        self._within_step = False

    def begin(self, setup: Setup) -> None:
        """Open the bag. Raises: RecordingError: it cannot be written. ScenarioError: /map would be too large."""
        self._steps, self._within_step = 0, False
        self._make = BagTypes()
        self._contents = BagMessages(setup, self._make, localized=self._localized)
        try:
            check_size(self._path, setup)
            check_replaceable(self._path)
            self._created = make_folder(self._path.parent)
            self._remove_active()
            self._writer = self._open()
            self._connections = {topic.name: self._connect(topic) for topic in self._contents.topics()}
        except OSError as error:
            remove_empty(self._created)
            raise cannot_write(self._path, error) from error

    def step(self, record: StepRecord) -> None:
        """Write the messages of one step. Raises: RecordingError: the bag cannot be written, such as on a full disk."""
        assert self._writer is not None
        self._within_step = True
        try:
            for time_ns, topic, message in self._contents.of_step(record):
                connection = self._connections[topic]
                data = self._make.typestore.serialize_ros1(message, connection.msgtype)
                self._writer.write(connection, time_ns, data)
            assert self._writer.bio is not None
            self._writer.bio.flush()
            self._steps += 1
            self._within_step = False
        except OSError as error:
            raise self._write_error(error) from error

    def end(self, result: Result) -> None:
        """Close the bag and rename it to `path`. Raises: RecordingError."""
        self._close()

    def abandon(self) -> None:
        """Close the bag of an interrupted run.

        An empty bag is deleted. After an incomplete step the .active file stays, for `rosbag reindex`.
        """
        if self._writer is None:
            return
        if self._steps == 0:
            self._close_file()
            self._active.unlink(missing_ok=True)
            remove_empty(self._created)
            return
        if self._within_step:
            self._close_file()
            return
        with contextlib.suppress(RecordingError):
            self._close()

    def _close(self) -> None:
        assert self._writer is not None
        try:
            self._writer.close()
            self._writer = None
            rename_complete(self._active, self._path)
        except OSError as error:
            raise self._write_error(error) from error

    def _open(self) -> _Writer:
        """Open the file. Raises: OSError. RecordingError: another program writes it."""
        try:
            writer = _Writer(self._active)
            writer.chunk_threshold = CHUNK_BYTES
            writer.open()
        except WriterError as error:
            raise taken(self._path, self._active) from error
        assert writer.bio is not None
        try:
            lock_active(writer.bio.fileno(), self._path, self._active)
        except RecordingError:
            writer.bio.close()
            raise
        return writer

    def _remove_active(self) -> None:
        """Delete the file of an earlier, killed run.

        Raises: OSError. RecordingError: it is something else, or another program writes it.
        """
        if os.path.lexists(self._active):
            with open_regular(self._active) as file:
                if file.read(len(_MAGIC)) not in (b"", _MAGIC):
                    raise RecordingError(
                        f"{self._path}: cannot be written: {self._active} would be overwritten; move it first"
                    )
                lock_active(file.fileno(), self._path, self._active)
            self._active.unlink()

    def _write_error(self, error: OSError) -> RecordingError:
        """Close the file without an index, and return the error for the user."""
        self._close_file()
        why = error.strerror or error
        rescue = f"`rosbag reindex {self._active}` recovers what was recorded"
        return RecordingError(f"{self._active}: cannot be written: {why}; {rescue}")

    def _close_file(self) -> None:
        if self._writer is not None and self._writer.bio is not None:
            # Closing flushes, which fails again on a full disk.
            with contextlib.suppress(OSError):
                self._writer.bio.close()
        self._writer = None

    def _connect(self, topic: BagTopic) -> Any:
        assert self._writer is not None
        return self._writer.add_connection(
            topic.name,
            topic.type_name.replace("/", "/msg/"),
            typestore=self._make.typestore,
            callerid="/robotteamsim",
            latching=int(topic.latched),
        )
