"""The progress bar of a running mission."""

from __future__ import annotations

import time

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn

from robotteamsim.scenario.scenario import Scenario
from robotteamsim.simulation import Result, StepRecord

_REFRESH_S = 0.1


class ProgressBar:
    """Shows mission time, areas, victims and speed while a mission runs; silent where there is no terminal."""

    def __init__(self, console: Console) -> None:
        self._progress = Progress(
            TextColumn("[bold]{task.description}"),
            BarColumn(),
            TextColumn("{task.fields[figures]}"),
            console=console,
            disable=not console.is_terminal,
            transient=True,
            auto_refresh=False,
        )

    def begin(self, scenario: Scenario) -> None:
        """Show the bar; it fills with the mission's time limit."""
        self._progress.start()
        self._task = self._progress.add_task(scenario.name, total=scenario.mission.time_limit_s, figures="")
        self._start_s = self._shown_s = time.monotonic()

    def step(self, record: StepRecord) -> None:
        """Show a step, a few times a second."""
        now_s = time.monotonic()
        if now_s - self._shown_s < _REFRESH_S:
            return
        self._shown_s = now_s
        status = record.mission
        speed = record.sim_time_s / (now_s - self._start_s)
        figures = (
            f"{status.time_s:5.0f} s  areas {status.areas_explored}/{len(status.explored)}  "
            f"victims {status.victims_saved}/{len(status.victims)}  {speed:.0f} x real time"
        )
        self._progress.update(self._task, completed=status.time_s, figures=figures, refresh=True)

    def end(self, result: Result) -> None:
        """Take the bar away."""
        self._progress.stop()

    def abandon(self) -> None:
        """Take the bar away."""
        self._progress.stop()
