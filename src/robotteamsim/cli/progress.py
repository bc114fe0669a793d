"""The progress of a running mission, and of a campaign with the remaining time."""

from __future__ import annotations

import time
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    SpinnerColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

if TYPE_CHECKING:
    from robotteamsim.campaign import Outcome
    from robotteamsim.setup import Setup
    from robotteamsim.simulation import Result, StepRecord

_REFRESH_S = 0.1
_LINE_EVERY_S = 10.0


def working(console: Console, name: str, what: str) -> AbstractContextManager[object]:
    """Return a context that shows what is done, and for how long it has been; does nothing without a terminal."""
    columns = SpinnerColumn(), TextColumn("[bold]{task.description}"), TextColumn(what), TimeElapsedColumn()
    progress = Progress(*columns, console=console, disable=not console.is_terminal, transient=True)
    progress.add_task(name, total=None)
    return progress


class ProgressBar:
    """Shows mission time, areas, victims and speed while a mission runs; does nothing without a terminal.

    The elapsed time also advances during a long step, such as one that plans in a large building.
    """

    def __init__(self, console: Console) -> None:
        self._progress = Progress(
            SpinnerColumn(),
            TextColumn("[bold]{task.description}"),
            BarColumn(),
            TextColumn("{task.fields[note]}"),
            TimeElapsedColumn(),
            console=console,
            disable=not console.is_terminal,
            transient=True,
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
        self._progress.update(self._task, completed=status.time_s, note=note)

    def end(self, result: Result) -> None:
        """Remove the bar."""
        self._progress.stop()

    def abandon(self) -> None:
        """Remove the bar."""
        self._progress.stop()


class CampaignProgress:
    """A progress bar on a terminal, or a line every 10 s elsewhere; a context manager."""

    def __init__(self, console: Console, name: str, total: int, done: int) -> None:
        self._console, self._name, self._total, self._done, self._done_before = console, name, total, done, done
        self._failed = 0
        self._simulated_s = 0.0
        self._bar: Progress | None = None
        if console.is_terminal:
            self._bar = Progress(
                TextColumn("[bold]{task.description}"),
                BarColumn(),
                MofNCompleteColumn(),
                TimeElapsedColumn(),
                TextColumn("left"),
                TimeRemainingColumn(),
                TextColumn("{task.fields[note]}"),
                console=console,
                transient=True,
                speed_estimate_period=600.0,
            )
            self._task = self._bar.add_task(name, total=total, completed=done, note="starting workers")

    def __enter__(self) -> CampaignProgress:
        self._start_s = self._printed_s = time.monotonic()
        if self._bar:
            self._bar.start()
        else:
            before = f", {self._done} of them already done" if self._done else ""
            self.print_line(f"{self._name}: {self._total} trials{before}")
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar:
            self._bar.stop()

    def add(self, outcome: Outcome) -> None:
        """Count one more finished trial."""
        self._done += 1
        self._failed += outcome.failed
        self._simulated_s += outcome.time_s or 0.0
        failures = f"{self._failed} failed" if self._failed else ""
        if self._bar:
            self._bar.update(self._task, advance=1, note=failures)
            return
        now_s = time.monotonic()
        if now_s - self._printed_s >= _LINE_EVERY_S or self._done == self._total:
            self._printed_s = now_s
            left_s = (now_s - self._start_s) / (self._done - self._done_before) * (self._total - self._done)
            self.print_line(f"{self._done} of {self._total} trials, {left_s:.0f} s left{failures and ', ' + failures}")

    def finish(self) -> None:
        """Print how long the campaign took."""
        wall_s, count = time.monotonic() - self._start_s, self._done - self._done_before
        self.print_line(
            f"{count} trials, {self._simulated_s / 60.0:,.1f} min of missions, in {wall_s:.1f} s: "
            f"{self._simulated_s / wall_s:,.0f} times real time"
        )

    def print_line(self, line: str) -> None:
        """Print a line, above the bar if there is one."""
        self._console.print(line, markup=False, highlight=False, soft_wrap=True)
