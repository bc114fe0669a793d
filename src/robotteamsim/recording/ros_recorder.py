"""What the recorders of bags of ROS 1 and of MCAP files have in common."""

import contextlib
import os
import shutil
from abc import ABC, abstractmethod
from pathlib import Path
from typing import Any

from rosbags import rosbag1, rosbag2
from rosbags.typesys import Stores

from robotteamsim.errors import RecordingError
from robotteamsim.recording.bag import BagMessages, BagTopic, check_size
from robotteamsim.recording.bag_types import bag_typestore, message_type
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


class RosRecorder(ABC):
    """Writes the topics of a ROS run to a file while the trial runs.

    Like `rosbag record`, it writes to `path`.active, and the file becomes `path` when the run ends or is interrupted
    between steps. After a kill or a full disk, the .active one stays.
    """

    _ros: Stores
    _rescue: str
    """The command that repairs a file that was not closed."""

    def __init__(self, path: Path, *, localized: bool = False) -> None:
        """Args: localized: as with `localization:=ground_truth`, see `Source`."""
        self._path, self._localized = path, localized
        self._active = self._temporary = path.parent / f"{path.name}.active"
        self._writer: Any = None
        self._created: list[Path] = []
        self._steps = 0
        self._within_step = False

    def begin(self, setup: Setup) -> None:
        """Open the file. Raises: RecordingError: it cannot be written. ScenarioError: /map would be too large."""
        self._steps, self._within_step = 0, False
        self._contents = BagMessages(setup, localized=self._localized)
        types = {topic.name: message_type(topic.type_name, self._ros) for topic in self._contents.topics()}
        self._encode = {name: of_type.encode for name, of_type in types.items()}
        try:
            check_size(self._path, setup)
            check_replaceable(self._path)
            self._created = make_folder(self._path.parent)
            self._remove_earlier()
            self._open()
            self._connections = {topic.name: self._connect(topic) for topic in self._contents.topics()}
        except OSError as error:
            remove_empty(self._created)
            raise cannot_write(self._path, error) from error

    def step(self, record: StepRecord) -> None:
        """Write the messages of one step. Raises: RecordingError: the file cannot be written, as on a full disk."""
        self._within_step = True
        try:
            for time_ns, topic, message in self._contents.of_step(record):
                try:
                    data = self._encode[topic](message)
                except (TypeError, ValueError) as error:  # of a sensor of a user's own
                    raise RecordingError(f"{topic}: {error}") from None
                self._writer.write(self._connections[topic], time_ns, data)
            self._file.flush()
            self._steps += 1
            self._within_step = False
        except OSError as error:
            raise self._write_error(error) from error

    def end(self, result: Result) -> None:
        """Write the index, and move the file to `path`. Raises: RecordingError."""
        self._close()

    def abandon(self) -> None:
        """Close the file of an interrupted run; an empty one is deleted.

        After an incomplete step the .active one stays: its last message may be incomplete.
        """
        if self._writer is None:
            return
        if self._steps and not self._within_step:
            with contextlib.suppress(RecordingError):
                self._close()
            return
        self._abort()
        if not self._steps:
            with contextlib.suppress(OSError):
                self._remove_temporary()
            remove_empty(self._created)

    def _close(self) -> None:
        try:
            self._writer.close()
            self._writer = None
            rename_complete(self._active, self._path)
            if self._temporary != self._active:
                self._remove_temporary()
        except OSError as error:
            raise self._write_error(error) from error

    def _write_error(self, error: OSError) -> RecordingError:
        """Close the file without an index, and return the error for the user."""
        self._abort()
        rescue = self._rescue.format(active=self._active, path=self._path)
        return RecordingError(f"{cannot_write(self._active, error)}; `{rescue}` recovers what was recorded")

    def _abort(self) -> None:
        if self._file is not None:
            # Closing flushes, which fails again on a full disk.
            with contextlib.suppress(OSError):
                self._file.close()
        self._writer = None

    def _remove_earlier(self) -> None:
        """Delete what an earlier, killed run has left.

        Raises: OSError. RecordingError: it is something else, or another program writes it.
        """
        if not os.path.lexists(self._temporary):
            return
        if not self._is_ours():
            text = f"{self._temporary} would be overwritten; move it first"
            raise RecordingError(f"{self._path}: cannot be written: {text}")
        if self._active.exists():
            with open_regular(self._active) as file:
                lock_active(file.fileno(), self._path, self._active)
        self._remove_temporary()

    def _open(self) -> None:
        """Open the file. Raises: OSError. RecordingError: another program writes it."""
        try:
            writer = self._new_writer()
            writer.open()
        except (rosbag1.WriterError, rosbag2.WriterError) as error:
            raise taken(self._path, self._temporary) from error
        except OSError:
            with contextlib.suppress(OSError):
                self._remove_temporary()
            raise
        self._writer = writer
        try:
            lock_active(self._file.fileno(), self._path, self._active)
        except RecordingError:
            self._abort()
            raise

    def _connect(self, topic: BagTopic) -> Any:
        kind, store = topic.type_name.replace("/", "/msg/"), bag_typestore(self._ros)
        return self._writer.add_connection(topic.name, kind, typestore=store, **self._settings(latched=topic.latched))

    @property
    def _file(self) -> Any:
        """The open file; None: it is closed."""
        return getattr(getattr(self._writer, "storage", self._writer), "bio", None)

    def _remove_temporary(self) -> None:
        """Delete what is left at `path`.active. Raises: OSError."""
        if self._temporary.is_dir():
            shutil.rmtree(self._temporary)
        else:
            self._temporary.unlink(missing_ok=True)

    @abstractmethod
    def _new_writer(self) -> Any:
        """Return a writer of rosbags, not open yet."""

    @abstractmethod
    def _is_ours(self) -> bool:
        """Whether a recorder wrote what is at `path`.active."""

    @abstractmethod
    def _settings(self, *, latched: bool) -> dict[str, Any]:
        """Return what a connection of rosbags also needs."""
