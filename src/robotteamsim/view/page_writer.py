"""Writes the page of a mission when it ends."""

from __future__ import annotations

from pathlib import Path

from robotteamsim.recording.files import check_replaceable, write_atomically
from robotteamsim.setup import Setup
from robotteamsim.simulation import Result, Simulation
from robotteamsim.view.html import mission_page
from robotteamsim.view.recorder import FrameRecorder


class PageWriter(FrameRecorder):
    """Records a simulation, and writes the page that plays it when the mission has ended, completely or not at all."""

    def __init__(self, path: Path, simulation: Simulation) -> None:
        super().__init__(simulation)
        self._path = path

    def begin(self, setup: Setup) -> None:
        """Raises: RecordingError: the file cannot be written."""
        check_replaceable(self._path)

    def end(self, result: Result) -> None:
        """Write the page. Raises: RecordingError."""
        write_atomically(self._path, mission_page([self.recording], self.recording.title))
