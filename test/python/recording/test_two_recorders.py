"""Two programs that begin to record to one file at the same moment: one of them is told so in one line."""

from __future__ import annotations

from pathlib import Path

import pytest
from rosbags import rosbag1, rosbag2

from robotteamsim.errors import RecordingError
from robotteamsim.recording import BagWriter, McapWriter


@pytest.mark.parametrize(
    ("recorder", "library", "name"),
    [
        pytest.param(BagWriter, rosbag1.Writer, "mission.bag", id="bag"),
        pytest.param(McapWriter, rosbag2.Writer, "mission.mcap", id="mcap"),
    ],
)
def test_file_that_another_program_has_just_opened_is_named(trial, tmp_path, monkeypatch, recorder, library, name):
    active = tmp_path / f"{name}.active"
    open_file = library.open

    def open_second(writer: object) -> None:
        """Open the file when another program has opened it first."""
        _open_first(active, folder=library is rosbag2.Writer)
        open_file(writer)

    monkeypatch.setattr(library, "open", open_second)
    with pytest.raises(RecordingError) as refused:
        recorder(tmp_path / name).begin(trial.setup)
    assert str(refused.value) == f"{tmp_path / name}: cannot be written: another program writes {active}"
    assert active.exists()


def _open_first(active: Path, *, folder: bool) -> None:
    if folder:
        active.mkdir()
    else:
        active.touch()
