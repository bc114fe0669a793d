"""Two programs open the same recording at once: one of them gets a one-line error."""

from __future__ import annotations

from pathlib import Path

import pytest
from rosbags import rosbag1, rosbag2

from robotteamsim.errors import RecordingError
from robotteamsim.recording import BagWriter, McapWriter


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
        recorder(tmp_path / name).begin(trial.setup)
    assert str(refused.value) == f"{tmp_path / name}: cannot be written: another program writes {active}"
    assert active.exists()
