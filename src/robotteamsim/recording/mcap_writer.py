"""Writes an MCAP file of a headless run, for Foxglove, Lichtblick, Rerun and ROS 2."""

import contextlib
import os
import shutil
from pathlib import Path
from typing import Any, Literal

from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
from rosbags.rosbag2 import StoragePlugin, Writer, WriterError

from robotteamsim.errors import RecordingError
from robotteamsim.recording.bag import BagMessages, BagTopic, check_size
from robotteamsim.recording.bag_types import Ros2Types
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

SUFFIX = ".mcap"

_VERSION: Literal[8] = 8
"""Of rosbag2's metadata; ROS 2 Humble cannot read the form of quality of service in version 9."""

_QUEUE = 10
_UNLIMITED = QosTime(2147483647, 4294967295)


class McapWriter:
    """Writes an MCAP file with the topics of `BagWriter` and ROS 2 messages, with the definitions of all types.

    rosbags writes a folder with one file and its metadata: `path`.active. At the end, the file becomes `path`. After a
    kill or a full disk, the folder stays, for `mcap recover`.
    """

    def __init__(self, path: Path, *, localized: bool = False) -> None:
        """Args: localized: whether /tf also has map -> odom of each robot, as with `localization:=ground_truth`."""
        self._path, self._localized = path, localized
        self._folder = path.parent / f"{path.name}.active"
        self._active = self._folder / f"{self._folder.name}{SUFFIX}"
        self._writer: Writer | None = None
        self._created: list[Path] = []
        self._steps = 0

    def begin(self, setup: Setup) -> None:
        """Open the file. Raises: RecordingError: it cannot be written. ScenarioError: /map would be too large."""
        self._make = Ros2Types()
        self._contents = BagMessages(setup, self._make, localized=self._localized)
        self._steps = 0
        try:
            check_size(self._path, setup)
            check_replaceable(self._path)
            self._created = make_folder(self._path.parent)
            self._remove_earlier()
            self._writer = self._open()
            self._connections = {topic.name: self._connect(topic) for topic in self._contents.topics()}
        except OSError as error:
            remove_empty(self._created)
            raise cannot_write(self._path, error) from error

    def step(self, record: StepRecord) -> None:
        """Write the messages of one step. Raises: RecordingError: the file cannot be written."""
        assert self._writer is not None
        try:
            for time_ns, topic, message in self._contents.of_step(record):
                connection = self._connections[topic]
                data = self._make.typestore.serialize_cdr(message, connection.msgtype)
                self._writer.write(connection, time_ns, data)
            self._steps += 1
        except OSError as error:
            raise self._write_error(error) from error

    def end(self, result: Result) -> None:
        """Write the index, and move the file to `path`. Raises: RecordingError."""
        self._close()

    def abandon(self) -> None:
        """Close the file of an interrupted run; an empty one is deleted."""
        if self._writer is None:
            return
        if self._steps:
            with contextlib.suppress(RecordingError):
                self._close()
            return
        self._abort()
        with contextlib.suppress(OSError):
            shutil.rmtree(self._folder)
        remove_empty(self._created)

    def _close(self) -> None:
        assert self._writer is not None
        try:
            self._writer.close()
            self._writer = None
            rename_complete(self._active, self._path)
            shutil.rmtree(self._folder)
        except OSError as error:
            raise self._write_error(error) from error

    def _write_error(self, error: OSError) -> RecordingError:
        """Close the file without an index, and return the error for the user."""
        self._abort()
        why = error.strerror or error
        rescue = f"`mcap recover {self._active} -o {self._path}` recovers what was recorded"
        return RecordingError(f"{self._active}: cannot be written: {why}; {rescue}")

    def _abort(self) -> None:
        if self._writer is not None:
            # Closing flushes, which fails again on a full disk.
            with contextlib.suppress(OSError):
                self._writer.abort()
        self._writer = None

    def _open(self) -> Writer:
        """Open the file. Raises: OSError. RecordingError: another program writes it."""
        try:
            writer = Writer(self._folder, version=_VERSION, storage_plugin=StoragePlugin.MCAP)
            writer.open()
        except WriterError as error:
            raise taken(self._path, self._folder) from error
        except OSError:
            shutil.rmtree(self._folder, ignore_errors=True)
            raise
        try:
            lock_active(writer.storage.bio.fileno(), self._path, self._active)  # type: ignore[union-attr]
        except RecordingError:
            writer.abort()
            raise
        return writer

    def _remove_earlier(self) -> None:
        """Delete the folder of an earlier, killed run.

        Raises: OSError. RecordingError: it is something else, or another program writes it.
        """
        if not os.path.lexists(self._folder):
            return
        ours = {self._active.name, "metadata.yaml", "metadata.yaml.tmp"}
        if not self._folder.is_dir() or not ours.issuperset(os.listdir(self._folder)):
            raise RecordingError(f"{self._path}: cannot be written: {self._folder} would be overwritten; move it first")
        if self._active.exists():
            with open_regular(self._active) as file:
                lock_active(file.fileno(), self._path, self._active)
        shutil.rmtree(self._folder)

    def _connect(self, topic: BagTopic) -> Any:
        assert self._writer is not None
        return self._writer.add_connection(
            topic.name,
            topic.type_name.replace("/", "/msg/"),
            typestore=self._make.typestore,
            offered_qos_profiles=[_quality(latched=topic.latched)],
        )


def _quality(*, latched: bool) -> Qos:
    """Return the quality of service; ROS 2 keeps the last message of a latched topic for later subscribers."""
    return Qos(
        history=QosHistory.KEEP_LAST,
        depth=1 if latched else _QUEUE,
        reliability=QosReliability.RELIABLE,
        durability=QosDurability.TRANSIENT_LOCAL if latched else QosDurability.VOLATILE,
        deadline=_UNLIMITED,
        lifespan=_UNLIMITED,
        liveliness=QosLiveliness.AUTOMATIC,
        liveliness_lease_duration=_UNLIMITED,
        avoid_ros_namespace_conventions=False,
    )
