"""Prints the events and the result of a mission."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from robotteamsim.mission.events import AnyEvent
from robotteamsim.mission.status import END_TEXTS
from robotteamsim.recording.idleness import Idleness
from robotteamsim.simulation import Result
from robotteamsim.wording import counted, printable

MAX_EVENTS = 60
"""Above this number of events, endangered links are only counted; mission.json lists them."""

_STYLES = {
    "victim_saved": "green",
    "area_explored": "cyan",
    "discovery_delivered": "blue",
    "victim_heard": "yellow",
    "victim_located": "yellow",
    "victim_reported": "blue",
    "victim_safe": "green",
    "victim_dead": "red",
    "person_enclosed": "red",
    "link_endangered": "red",
    "robot_excluded": "magenta",
    "controller_failed": "red",
    "robot_included": "magenta",
    "swarm_founded": "magenta",
    "swarm_dissolved": "magenta",
    "end": "bold",
}


def print_result(
    console: Console,
    result: Result,
    events: Sequence[AnyEvent],
    written: Sequence[Path | None],
    idleness: Idleness | None = None,
) -> None:
    """Print the events in order and the totals of a mission; idleness: of a patrol."""
    console.print(event_table(_title(result), events))
    print_totals(console, result, written, idleness)


def print_totals(
    console: Console, result: Result, written: Sequence[Path | None], idleness: Idleness | None = None
) -> None:
    """Print the totals of a mission, its hash and the written files."""
    console.print(totals_table([*_totals(result), *_idleness_rows(idleness)]))
    console.print(Text(f"  trajectories {result.trajectory_hash}"), soft_wrap=True)
    for path in filter(None, written):
        console.print(Text(f"  written      {path}"), soft_wrap=True)


def event_table(title: str, events: Sequence[AnyEvent]) -> Table:
    """Return the events in order; if there are many, endangered links are only counted."""
    heading = Text(printable(title), style="bold")
    table = Table(title=heading, title_justify="left", box=box.SIMPLE_HEAD, caption_justify="left")
    table.add_column("time", justify="right", no_wrap=True)
    table.add_column("what happened")
    shown = events
    if len(events) > MAX_EVENTS:
        shown = [event for event in events if event.kind != "link_endangered"]
        if len(shown) < len(events):
            table.caption = f"and {counted(len(events) - len(shown), 'endangered link')}"
    for event in shown:
        table.add_row(f"{event.time_s:.1f} s", Text(printable(event.detail), style=_STYLES.get(event.kind, "")))
    return table


def delivery_rows(delivered: int | None, mean_s: float | None, max_s: float | None) -> list[tuple[str, str]]:
    """Return the row about discoveries delivered to the base, or nothing if there is no base."""
    if delivered is None:
        return []
    delay = "" if mean_s is None else f", after {mean_s:.1f} s on average, {max_s:.1f} s at most"
    discoveries = "1 discovery" if delivered == 1 else f"{delivered} discoveries"
    return [("reached base", f"{discoveries}{delay}")]


def _idleness_rows(idleness: Idleness | None) -> list[tuple[str, str]]:
    if idleness is None:
        return []
    over = f"{len(idleness.vertices)} vertices"
    return [("idleness", f"{idleness.mean_s:.1f} s on average, {idleness.max_s:.1f} s at most, of {over}")]


def totals_table(rows: Iterable[tuple[str, str]]) -> Table:
    """Return names and values in two columns."""
    table = Table(box=None, show_header=False, pad_edge=True)
    table.add_column(style="dim")
    table.add_column()
    for name, value in rows:
        table.add_row(name, value)
    return table


def _title(result: Result) -> str:
    robots = counted(len(result.robots), "robot")
    return f"{result.scenario}: {robots}, {result.noise_db:g} dB noise, seed {result.seed}"


def _totals(result: Result) -> list[tuple[str, str]]:
    distances = ", ".join(f"{robot.distance_m:.0f}" for robot in result.robots[:10])
    more = " .." if len(result.robots) > 10 else ""
    return [
        ("end", END_TEXTS[result.end]),
        ("areas explored", f"{result.areas_explored} of {result.num_areas}"),
        ("victims saved", f"{result.victims_saved} of {result.num_victims}"),
        *delivery_rows(result.discoveries_delivered, result.mean_delivery_delay_s, result.max_delivery_delay_s),
        ("time", f"{result.time_s:.1f} s"),
        ("endangered links", str(result.endangered_links)),
        ("driven", f"{distances}{more} m"),
        ("speed", f"{result.speed:.0f} x real time ({result.wall_s:.1f} s)"),
    ]
