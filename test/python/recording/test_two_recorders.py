"""Two programs write the same recording at once: the second gets a one-line error, and the first loses nothing."""

from __future__ import annotations

import errno
import fcntl
from pathlib import Path

import pytest
from rosbags import rosbag1, rosbag2
from rosbags.rosbag2 import storage_mcap

from robotteamsim.errors import RecordingError
from robotteamsim.recording import BagWriter, McapWriter, ros_recorder
from robotteamsim.recording.files import lock_active
from robotteamsim.simulation.trial import Trial

RECORDERS = pytest.mark.parametrize(("recorder", "name"), [(BagWriter, "mission.bag"), (McapWriter, "mission.mcap")])


@pytest.mark.parametrize(
    ("recorder", "library", "name", "make_first"),
    [
        pytest.param(BagWriter, rosbag1.Writer, "mission.bag", Path.touch, id="bag"),
        pytest.param(McapWriter, rosbag2.Writer, "mission.mcap", Path.mkdir, id="mcap"),
    ],
)
def test_file_that_another_program_has_just_opened_is_named(
    trial, tmp_path, monkeypatch, recorder, library, name, make_first
):
    active = tmp_path / f"{name}.active"
    open_file = library.open

    def open_second(writer: object) -> None:
        """Open the file when another program has opened it first."""
        make_first(active)
        open_file(writer)

    monkeypatch.setattr(library, "open", open_second)
    with pytest.raises(RecordingError) as refused:
        Trial(trial.setup, [recorder(tmp_path / name)])
    assert str(refused.value) == f"{tmp_path / name}: cannot be written: another program writes {active}"
    assert active.exists()


@RECORDERS
def test_recording_that_goes_on_is_not_replaced(trial, tmp_path, recorder, name):
    first, path = recorder(tmp_path / name), tmp_path / name
    first.begin(trial.setup)
    with pytest.raises(RecordingError, match=f"another program writes .*{name}.active"):
        Trial(trial.setup, [recorder(path)])
    for record in trial.records(3):
        first.step(record)
    first.end(trial.result(3))
    whole = path.read_bytes()
    Trial(trial.setup, [recorder(path)]).abandon()
    assert [path.name for path in tmp_path.iterdir()] == [name]
    assert path.read_bytes() == whole


@RECORDERS
def test_file_systems_without_locks_hold_recordings(trial, tmp_path, monkeypatch, recorder, name):
    def flock(_descriptor: int, _operation: int) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(fcntl, "flock", flock)
    recording = recorder(tmp_path / name)
    recording.begin(trial.setup)
    recording.step(trial.record(1))
    recording.end(trial.result(3))
    assert (tmp_path / name).is_file()


def test_file_that_another_program_has_replaced_before_it_is_locked_is_named(tmp_path):
    path, active = tmp_path / "mission.bag", tmp_path / "mission.bag.active"
    with active.open("xb") as file:
        lock_active(file.fileno(), path, active)
        active.unlink()
        with pytest.raises(RecordingError, match="another program writes"):
            lock_active(file.fileno(), path, active)
        active.touch()
        with pytest.raises(RecordingError, match="another program writes"):
            lock_active(file.fileno(), path, active)


@RECORDERS
def test_interrupted_step_leaves_an_active_file_and_not_the_name_of_a_complete_one(
    trial, tmp_path, monkeypatch, recorder, name
):
    def interrupt(*_arguments: object) -> None:
        """Interrupt between the index of a chunk and its record, in an MCAP file; before any, in a bag."""
        raise KeyboardInterrupt

    recording = recorder(tmp_path / name)
    recording.begin(trial.setup)
    recording.step(trial.record(1))
    monkeypatch.setattr(storage_mcap, "write_record", interrupt)
    monkeypatch.setattr("robotteamsim.recording.bag_writer._Writer.write", interrupt)
    with pytest.raises(KeyboardInterrupt):
        recording.step(trial.record(2))
    monkeypatch.undo()
    recording.abandon()
    assert [path.name for path in tmp_path.iterdir()] == [f"{name}.active"]


def test_file_that_another_program_opens_once_a_bag_is_complete_stays(trial, tmp_path, monkeypatch):
    active, complete = tmp_path / "mission.bag.active", ros_recorder.rename_complete

    def complete_and_open(part: Path, path: Path) -> None:
        complete(part, path)
        active.touch()

    monkeypatch.setattr(ros_recorder, "rename_complete", complete_and_open)
    trial.play(BagWriter(tmp_path / "mission.bag"), steps=1)
    assert active.exists()
