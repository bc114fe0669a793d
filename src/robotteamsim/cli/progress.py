"""The progress bar of a running mission."""

import time

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn

from robotteamsim.setup import Setup
from robotteamsim.simulation import Result, StepRecord

_REFRESH_S = 0.1


class ProgressBar:
    """Shows mission time, areas, victims and speed while a mission runs; does nothing without a terminal."""

    def __init__(self, console: Console) -> None:
        self._progress = Progress(
            TextColumn("[bold]{task.description}"),
            BarColumn(),
            TextColumn("{task.fields[note]}"),
            console=console,
            disable=not console.is_terminal,
            transient=True,
            auto_refresh=False,
        )

    def begin(self, setup: Setup) -> None:
        """Show the bar, which is full at the mission's time limit."""
        self._progress.start()
        scenario = setup.scenario
        self._task = self._progress.add_task(scenario.name, total=scenario.mission.time_limit_s, note="")
        self._start_s = self._shown_s = time.monotonic()

    def step(self, record: StepRecord) -> None:
        """Update the bar, at most ten times a second."""
        now_s = time.monotonic()
        if now_s - self._shown_s < _REFRESH_S:
            return
        self._shown_s = now_s
        status = record.mission
        speed = record.sim_time_s / (now_s - self._start_s)
        note = (
            f"{status.time_s:5.0f} s  areas {status.areas_explored}/{len(status.explored)}  "
            f"victims {status.victims_saved}/{len(status.victims)}  {speed:.0f} x real time"
        )
        self._progress.update(self._task, completed=status.time_s, note=note, refresh=True)

    def end(self, result: Result) -> None:
        """Remove the bar."""
        self._progress.stop()

    def abandon(self) -> None:
        """Remove the bar."""
        self._progress.stop()
