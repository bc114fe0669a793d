"""Tables of missions for a terminal: one that ended now, one recorded run, or one line for each of several runs."""

from __future__ import annotations

import statistics
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from robotteamsim.hazards.field import FARTHEST_SIGHT_M
from robotteamsim.mission.status import END_TEXTS
from robotteamsim.wording import column_groups, counted, printable

if TYPE_CHECKING:
    from robotteamsim.analysis.runs.totals import MissionTotals, RobotTotals, RunTotals
    from robotteamsim.mission.egress import Egress
    from robotteamsim.mission.events import AnyEvent
    from robotteamsim.recording.measures import Measured
    from robotteamsim.recording.replay.gaps import Gap
    from robotteamsim.recording.replay.recorded_run import RecordedRun
    from robotteamsim.simulation import Result
    from robotteamsim.simulation.timings import StageTime

MAX_EVENTS = 60
"""Above this number of events, endangered links are only counted; mission.json lists them."""

MAX_GAPS = 12
"""Most topics with missing steps that are listed; JSON and tables list all."""

MAX_PEOPLE = 40
"""Most people in the table of doses."""

_LEAST_DOSE = 0.005
"""Smaller doses are shown as 0."""

_STYLES = {
    "ignition": "red",
    "door_burnt": "red",
    "visibility_lost": "red",
    "exit_untenable": "red",
    "victim_collapsed": "red",
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
_UNKNOWN = "-"
_MARK = "*"
"""After totals that are computed from topics with missing steps."""
_RUN_COLUMNS = (
    *("bag", "end", "areas", "victims", "time\n[s]", "endan-\ngered", "driven\n[m]", "colli-\nsions", "Fied-\nler"),
    "split\n[s]",
)
_ROBOT_COLUMNS = (
    *("robot", "driven\n[m]", "speed\n[m/s]", "fastest\nsecond", "colli-\nsions", "contact\n[s]", "excluded\n[s]"),
    "path\nfrom",
)
_MAX_NAME_WIDTH = 24
_PADDING = 2
"""Of each column."""
_EDGES = 2
"""Left and right of a table."""
_SHORT_ENDS = {
    "": "not in bag",
    "areas_explored": "explored",
    "time_limit": "time limit",
    "all_excluded": "excluded",
    "victims_safe": "all safe",
    "none_left": "none left",
    "search_over": "search over",
}


def print_result(
    console: Console,
    result: Result,
    events: Sequence[AnyEvent],
    written: Sequence[Path | None],
    measured: Measured | None = None,
) -> None:
    """Print the events in order and the totals of a mission."""
    console.print(_event_table(_title(result), events))
    print_totals(console, result, written, measured)


def print_totals(
    console: Console, result: Result, written: Sequence[Path | None], measured: Measured | None = None
) -> None:
    """Print the totals of a mission, its hash and the written files."""
    console.print(_totals_table([*_result_rows(result), *egress_rows(result.egress), *_measured_rows(measured)]))
    if result.egress is not None and result.egress.ignition_s is not None:
        console.print(_people_table(result.egress))
    console.print(_text(f"  trajectories {result.trajectory_hash}"), soft_wrap=True)
    for path in filter(None, written):
        console.print(_text(f"  written      {path}"), soft_wrap=True)


def print_timings(console: Console, timings: Sequence[StageTime]) -> None:
    """Print where the time of a step went."""
    table = Table(title=_text("where the time went", "bold"), title_justify="left", box=box.SIMPLE_HEAD)
    table.add_column("stage")
    for heading in ("calls", "mean", "share"):
        table.add_column(heading, justify="right", no_wrap=True)
    for stage, calls, mean_s, share in timings:
        table.add_row(stage, f"{calls}", f"{1e6 * mean_s:.1f} us", f"{share:.1%}")
    console.print(table)


def _event_table(title: str, events: Sequence[AnyEvent]) -> Table:
    """Return the events in order; if there are many, endangered links are only counted."""
    heading = _text(title, "bold")
    table = Table(title=heading, title_justify="left", box=box.SIMPLE_HEAD, caption_justify="left")
    table.add_column("time", justify="right", no_wrap=True)
    table.add_column("what happened")
    shown = events
    if len(events) > MAX_EVENTS:
        shown = [event for event in events if event.kind != "link_endangered"]
        if len(shown) < len(events):
            table.caption = f"and {counted(len(events) - len(shown), 'endangered link')}"
    for event in shown:
        table.add_row(f"{event.time_s:.1f} s", _text(event.detail, _STYLES.get(event.kind, "")))
    return table


def print_run(console: Console, run: RecordedRun, totals: RunTotals) -> None:
    """Print the events of one run, its totals, those of its robots, and lines for everything omitted or incomplete."""
    if run.events:
        console.print(_event_table(totals.title, [event for _, event in run.events]))
    else:
        console.print(_text(totals.title, "bold"))
    rows = [("recorded", f"{totals.duration_s:.1f} s")]
    rows += _mission_rows(totals.mission) if totals.mission else []
    rows += egress_rows(totals.egress)
    rows += _network_rows(totals) if totals.network and totals.network.num_robots else []
    console.print(_totals_table(rows))
    if totals.egress is not None and totals.egress.ignition_s is not None:
        console.print(_people_table(totals.egress))
    if totals.robots:
        cells = [_robot_cells(robot, totals) for robot in totals.robots]
        for table in _fitting_tables(_ROBOT_COLUMNS, cells, None, console.width):
            console.print(table)
    if any(robot.context for robot in totals.robots):
        console.print(_context_table(totals))
    if totals.trajectory_hash:
        console.print(_text(f"  trajectories {totals.trajectory_hash}"), soft_wrap=True)
    _print_omitted(console, totals, "")


def print_runs(console: Console, all_totals: Sequence[RunTotals]) -> None:
    """Print one line per run, the means of all runs, and lines for everything omitted or incomplete."""
    rows = [_cells(totals) for totals in all_totals]
    for table in _fitting_tables(_RUN_COLUMNS, rows, _mean_cells(all_totals), console.width):
        console.print(table)
    for totals in all_totals:
        _print_omitted(console, totals, f"{totals.bag}: ")


def _fitting_tables(
    names: Sequence[str], rows: Sequence[Sequence[str]], last_row: Sequence[str] | None, width: int
) -> Iterator[Table]:
    """Yield tables below each other, with as many columns as fit into the width; each repeats the first column."""
    lines, every_row = [name.split("\n") for name in names], [*rows, *([last_row] if last_row else [])]
    widths = [max(len(text) for text in [*head, *(row[i] for row in every_row)]) for i, head in enumerate(lines)]
    first_width = _EDGES + min(widths[0], _MAX_NAME_WIDTH) + _PADDING
    for group in column_groups([column + _PADDING for column in widths[1:]], first_width, width):
        columns = [index + 1 for index in group]
        table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0))
        table.add_column(Text(names[0]), overflow="fold", max_width=_MAX_NAME_WIDTH)
        for column in columns:
            is_number = any(row[column][:1].isdigit() for row in rows)
            table.add_column(Text(names[column]), justify="right" if is_number else "left", no_wrap=True)
        for row in rows:
            table.add_row(_text(row[0]), *(_text(row[column]) for column in columns))
        if last_row:
            table.add_section()
            table.add_row(_text(last_row[0]), *(_text(last_row[column]) for column in columns))
        yield table


def _network_rows(totals: RunTotals) -> list[tuple[str, str]]:
    network = totals.network
    assert network is not None
    mark = _mark(totals, "mean_links")
    all_links = network.num_robots * (network.num_robots - 1) // 2
    hops = counted(network.max_hops, "hop")
    rows = [("endangered links", f"{network.endangered_links}{mark}")] if totals.mission is None else []
    fiedler = f"{network.mean_fiedler_value:.3f}{mark} on average, at least {network.min_fiedler_value:.3f}{mark}"
    return [
        *rows,
        ("links endangered for", f"{network.endangered_s:.1f}{mark} s"),
        (
            "links",
            f"{network.mean_links:.2f}{mark} of {all_links} on average, shortest paths of at most {hops}{mark}",
        ),
        ("Fiedler value", fiedler),
        ("team split for", f"{network.split_s:.1f}{mark} s"),
    ]


def _robot_cells(robot: RobotTotals, totals: RunTotals) -> list[str]:
    forms = {"distance_m": ".1f", "mean_speed_mps": ".2f", "max_speed_mps": ".2f", "collisions": "d"}
    forms |= {"contact_s": ".1f", "excluded_s": ".1f"}
    numbers = [_number(getattr(robot, name), form, _mark(totals, name, robot.name)) for name, form in forms.items()]
    return [robot.name, *numbers, robot.source]


def _mark(totals: RunTotals, name: str, robot: str | None = None) -> str:
    return _MARK if totals.lacks_steps(name, robot) else ""


def _context_table(totals: RunTotals) -> Table:
    """Return the means of the metrics and coefficients of the robots that adapt."""
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0))
    table.add_column("robot")
    for name in ("A_s", "S_n", "O_n", "P_n", "C_s", "alpha", "c1", "c2", "c3", "c4"):
        table.add_column(name, justify="right")
    for robot in totals.robots:
        if robot.context:
            mark = _mark(totals, "context", robot.name)
            table.add_row(_text(robot.name), *(f"{value:.2f}{mark}" for value in robot.context.values()))
    return table


def _numbers(totals: RunTotals) -> list[tuple[float | None, str, str, str]]:
    """Return value, form, form of the mean and what follows the value of each column with numbers."""
    mission, network = totals.mission, totals.network
    either = mission or network
    return [
        (mission.areas_explored if mission else None, "d", ".2f", f"/{mission.num_areas}" if mission else ""),
        (mission.victims_saved if mission else None, "d", ".2f", f"/{mission.num_victims}" if mission else ""),
        (mission.time_s if mission else None, ".1f", ".1f", ""),
        (either.endangered_links if either else None, "d", ".2f", "" if mission else _mark(totals, "endangered_links")),
        (totals.distance_m, ".0f", ".0f", _mark(totals, "distance_m")),
        (totals.collisions, "d", ".2f", _mark(totals, "collisions")),
        (network.mean_fiedler_value if network else None, ".2f", ".2f", _mark(totals, "mean_fiedler_value")),
        (network.split_s if network else None, ".1f", ".1f", _mark(totals, "split_s")),
    ]


def _cells(totals: RunTotals) -> list[str]:
    end = _SHORT_ENDS.get(totals.mission.end, totals.mission.end) if totals.mission else _UNKNOWN
    return [totals.bag, end, *(_number(value, form, mark) for value, form, _, mark in _numbers(totals))]


def _mean_cells(all_totals: Sequence[RunTotals]) -> list[str]:
    """Return the means over the bags that have the value."""
    cells = ["mean", ""]
    for column in zip(*map(_numbers, all_totals), strict=True):
        values = [value for value, *_ in column if value is not None]
        mark = _MARK if any(mark == _MARK for *_, mark in column) else ""
        cells.append(_number(statistics.fmean(values) if values else None, column[0][2], mark))
    return cells


def _number(value: float | None, form: str, mark: str = "") -> str:
    return _UNKNOWN if value is None else f"{value:{form}}{mark}"


def gap_lines(gaps: Sequence[Gap]) -> list[str]:
    """Return a line for each topic that lacks steps, up to a limit."""
    lines = [f"{gap.topic}: {gap.missing} of {gap.expected} steps missing" for gap in gaps[:MAX_GAPS]]
    more = [f"and {counted(len(gaps) - MAX_GAPS, 'more topic')} with missing steps"] if len(gaps) > MAX_GAPS else []
    return lines + more


def _print_omitted(console: Console, totals: RunTotals, prefix: str) -> None:
    lines = [*totals.notes, *(f"omitted: {line}" for line in totals.omitted), *gap_lines(totals.gaps)]
    if any(gap.totals for gap in totals.gaps):
        lines.append(f"totals marked {_MARK} are computed without the missing steps")
    for line in lines:
        console.print(_text(f"  {prefix}{line}", "yellow"), soft_wrap=True)


def _result_rows(result: Result) -> list[tuple[str, str]]:
    distances = ", ".join(f"{robot.distance_m:.0f}" for robot in result.robots[:10])
    more = " .." if len(result.robots) > 10 else ""
    return [
        *_mission_rows(result),
        *([("driven", f"{distances}{more} m")] if result.robots else []),
        ("speed", f"{result.speed:.0f} x real time ({result.wall_s:.1f} s)"),
    ]


def _mission_rows(mission: Result | MissionTotals) -> list[tuple[str, str]]:
    return [
        ("end", END_TEXTS.get(mission.end, mission.end or "not in this bag")),
        ("areas explored", f"{mission.areas_explored} of {mission.num_areas}"),
        ("victims saved", f"{mission.victims_saved} of {mission.num_victims}"),
        *_delivery_rows(mission),
        ("time", f"{mission.time_s:.1f} s"),
        ("endangered links", str(mission.endangered_links)),
    ]


def _delivery_rows(mission: Result | MissionTotals) -> list[tuple[str, str]]:
    """Return the row about discoveries delivered to the base, or nothing if there is no base."""
    count, mean_s, max_s = mission.discoveries_delivered, mission.mean_delivery_delay_s, mission.max_delivery_delay_s
    if count is None:
        return []
    delay = "" if mean_s is None else f", after {mean_s:.1f} s on average, {max_s:.1f} s at most"
    return [("reached base", f"{'1 discovery' if count == 1 else f'{count} discoveries'}{delay}")]


def egress_rows(egress: Egress | None) -> list[tuple[str, str]]:
    """Return the rows of names and values on fire, people and exits."""
    if egress is None:
        return []
    rows = [] if egress.ignition_s is None else [("fire begins", f"{egress.ignition_s:.1f} s")]
    if egress.has_ways_out:
        out = ", ".join(f"{name} {count}" for name, count in egress.num_out.items())
        rows.append(("people out", f"{sum(egress.num_out.values())} of {len(egress.people)}: {out}"))
        rows += _safe_egress_rows(egress)
    return rows


def _safe_egress_rows(egress: Egress) -> list[tuple[str, str]]:
    """Return required and available safe egress time, and when exits became untenable."""
    evacuees = egress.evacuees
    num_out, total = sum(person.out_s is not None for person in evacuees), len(evacuees)
    who = f"{total} people who flee" if any(person.flees for person in evacuees) else f"{total} people"
    since = "" if egress.ignition_s is None else " after ignition"
    known = egress.rset_s is not None
    rows = [("RSET", f"{egress.rset_s:.1f} s{since}: {who}" if known else f"not reached: {num_out} of {who} are safe")]
    if egress.ignition_s is None:
        return rows
    if egress.aset_s is None:
        rows.append(("ASET", "not reached: nobody met untenable conditions"))
    else:
        rows.append(("ASET", f"{egress.aset_s:.1f} s{since}: untenable for {egress.num_untenable} of {total}"))
    times_s = [(way.name, way.untenable_s) for way in egress.exits if way.untenable_s is not None]
    closed = ", ".join(f"{name} {time_s - egress.begin_s:.1f} s{since}" for name, time_s in times_s)
    return [*rows, ("untenable exits", closed or "none")]


def _people_table(egress: Egress) -> Table:
    """Return the doses of those who met smoke or heat, or are not safe, the largest first, and when they were safe."""
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), caption_justify="left")
    table.add_column("person", overflow="fold", max_width=_MAX_NAME_WIDTH)
    for name in ("FED\ngas", "FED\nheat", "least\nsight [m]", "untenable\n[s]", "safe\n[s]"):
        table.add_column(Text(name), justify="right", no_wrap=True)
    table.add_column("by")
    harmed = [
        person
        for person in egress.people
        if person.out_s is None or person.dose >= _LEAST_DOSE or person.least_visibility_m < FARTHEST_SIGHT_M
    ]
    for person in sorted(harmed, key=lambda person: -person.dose)[:MAX_PEOPLE]:
        table.add_row(
            Text(printable(person.name)),
            *(f"{person.gas:.2f}", f"{person.heat:.2f}", f"{person.least_visibility_m:.1f}"),
            *(_number(person.untenable_s, ".1f"), _number(person.out_s, ".1f")),
            Text(printable(person.exit or _UNKNOWN)),
        )
    captions = [f"and {len(harmed) - MAX_PEOPLE} with smaller doses"] if len(harmed) > MAX_PEOPLE else []
    if len(harmed) < len(egress.people):
        captions.append(f"and {len(egress.people) - len(harmed)} who met neither smoke nor heat and are safe")
    table.caption = "; ".join(captions) or None
    return table


def _measured_rows(measured: Measured | None) -> list[tuple[str, str]]:
    rows = []
    if measured is not None and (idleness := measured.idleness) is not None:
        over = f"{len(idleness.vertices)} vertices"
        rows.append(("idleness", f"{idleness.mean_s:.1f} s on average, {idleness.max_s:.1f} s at most, of {over}"))
    if measured is not None and measured.coverage is not None:
        rows.append(("floor covered", f"{100.0 * measured.coverage:.1f} %"))
    return rows


def _totals_table(rows: Iterable[tuple[str, str]]) -> Table:
    """Return names and values in two columns."""
    table = Table(box=None, show_header=False, pad_edge=True)
    table.add_column(style="dim")
    table.add_column()
    for name, value in rows:
        table.add_row(name, _text(value))
    return table


def _text(words: str, style: str = "") -> Text:
    """Return words that may come from a file: without markup, and with control characters escaped."""
    return Text(printable(words), style=style)


def _title(result: Result) -> str:
    robots = counted(len(result.robots), "robot")
    return f"{result.scenario}: {robots}, {result.noise_db:g} dB noise, seed {result.seed}"
