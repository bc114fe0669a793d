"""What happened in a mission, for people."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from robotteamsim.mission.status import Event, MissionEnd
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.simulation import Result, StepRecord
from robotteamsim.wording import counted

MAX_EVENTS = 60
"""Beyond this many, endangered links are left to mission.json."""

END_WORDS: dict[MissionEnd, str] = {
    "areas_explored": "all areas are explored",
    "time_limit": "the time was up",
    "all_excluded": "all robots were excluded",
    "none_left": "no robot was left",
    "aborted": "aborted",
}

_STYLES = {
    "victim_saved": "green",
    "area_explored": "cyan",
    "find_reported": "blue",
    "victim_heard": "yellow",
    "link_endangered": "red",
    "robot_excluded": "magenta",
    "controller_failed": "red",
    "robot_included": "magenta",
    "swarm_founded": "magenta",
    "swarm_dissolved": "magenta",
    "end": "bold",
}


class EventList:
    """Keeps the events of a run."""

    def __init__(self) -> None:
        self.events: list[Event] = []

    def begin(self, scenario: Scenario) -> None:
        """Start anew."""
        self.events = []

    def step(self, record: StepRecord) -> None:
        """Keep the events of one step."""
        self.events.extend(record.events)

    def end(self, result: Result) -> None:
        """Nothing is left to do."""

    def abandon(self) -> None:
        """Nothing is left to do."""


def print_result(
    console: Console, scenario: Scenario, result: Result, events: Sequence[Event], written: Sequence[Path | None]
) -> None:
    """Print the events in order and the figures of a mission."""
    robots = counted(len(result.robots), "robot")
    title = f"{result.scenario}: {robots}, {result.noise_db:g} dB noise, seed {result.seed}"
    console.print(event_table(title, events))
    console.print(_figure_table(result))
    console.print(Text(f"  trajectories {result.trajectory_hash}"), soft_wrap=True)
    for path in filter(None, written):
        console.print(Text(f"  written      {path}"), soft_wrap=True)


def event_table(title: str, events: Sequence[Event]) -> Table:
    """Return the events in order; where there are many, endangered links are only counted."""
    table = Table(title=title, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD, caption_justify="left")
    table.add_column("time", justify="right", no_wrap=True)
    table.add_column("what happened")
    shown = events
    if len(events) > MAX_EVENTS:
        shown = [event for event in events if event.kind != "link_endangered"]
        table.caption = f"and {len(events) - len(shown)} times a link became endangered"
    for event in shown:
        table.add_row(f"{event.time_s:.1f} s", Text(event.detail, style=_STYLES.get(event.kind, "")))
    return table


def report_rows(reported: int | None, mean_s: float | None, max_s: float | None) -> list[tuple[str, str]]:
    """Return what a table says of the finds that the base heard of; nothing where there is no base."""
    if reported is None:
        return []
    late = "" if mean_s is None else f", {mean_s:.1f} s after the find on average, {max_s:.1f} s at most"
    return [("base heard of", f"{reported} finds{late}")]


def _figure_table(result: Result) -> Table:
    table = Table(box=None, show_header=False, pad_edge=True)
    table.add_column(style="dim")
    table.add_column()
    distances = ", ".join(f"{robot.distance_m:.0f}" for robot in result.robots[:10])
    more = " .." if len(result.robots) > 10 else ""
    rows = [
        ("end", END_WORDS[result.end]),
        ("areas explored", f"{result.areas_explored} of {result.num_areas}"),
        ("victims saved", f"{result.victims_saved} of {result.num_victims}"),
        *report_rows(result.finds_reported, result.mean_report_delay_s, result.max_report_delay_s),
        ("time", f"{result.time_s:.1f} s"),
        ("endangered links", str(result.endangered_links)),
        ("driven", f"{distances}{more} m"),
        ("speed", f"{result.speed:.0f} x real time ({result.wall_s:.1f} s)"),
    ]
    for name, value in rows:
        table.add_row(name, value)
    return table
