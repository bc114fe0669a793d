"""Tables of recorded runs for a terminal: one run in detail, or several in one line each."""

from __future__ import annotations

import statistics
from collections.abc import Sequence

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from robotteamsim.analysis.runs.derived import MissionFigures, NetworkFigures, RobotTotals, RunFigures
from robotteamsim.analysis.runs.recorded_run import RecordedRun
from robotteamsim.recording.table import END_WORDS, event_table, report_rows

_UNKNOWN = "-"
_SHORT_ENDS = {
    "": "not in bag",
    "areas_explored": "explored",
    "time_limit": "time limit",
    "all_excluded": "excluded",
    "none_left": "none left",
}


def print_run(console: Console, run: RecordedRun, figures: RunFigures) -> None:
    """Print the events of one run, its figures, those of its robots, and what is left out."""
    if run.events:
        console.print(event_table(figures.title, [event for _, event in run.events]))
    else:
        console.print(Text(figures.title, style="bold"))
    console.print(_figure_table(figures))
    if figures.robots:
        console.print(_robot_table(figures.robots))
    if figures.trajectory_hash:
        console.print(Text(f"  trajectories {figures.trajectory_hash}"), soft_wrap=True)
    _print_left_out(console, figures, "")


def print_runs(console: Console, figures: Sequence[RunFigures]) -> None:
    """Print one line per run, the means of all, and what is left out."""
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0))
    table.add_column("bag", overflow="fold")
    table.add_column("end")
    for name in (
        "areas",
        "victims",
        "time\n[s]",
        "endan-\ngered",
        "driven\n[m]",
        "colli-\nsions",
        "Fied-\nler",
        "split\n[s]",
    ):
        table.add_column(Text(name), justify="right")
    for figure in figures:
        table.add_row(*_cells(figure))
    table.add_section()
    table.add_row(*_mean_cells(figures))
    console.print(table)
    for figure in figures:
        _print_left_out(console, figure, f"{figure.bag}: ")


def _figure_table(figures: RunFigures) -> Table:
    table = Table(box=None, show_header=False, pad_edge=True)
    table.add_column(style="dim")
    table.add_column()
    rows = [("recorded", f"{figures.duration_s:.1f} s")]
    rows += _mission_rows(figures.mission) if figures.mission else []
    rows += _network_rows(figures.network, figures.mission is None) if figures.network else []
    for name, value in rows:
        table.add_row(name, value)
    return table


def _mission_rows(mission: MissionFigures) -> list[tuple[str, str]]:
    return [
        ("end", _end_words(mission.end)),
        ("areas explored", f"{mission.areas_explored} of {mission.num_areas}"),
        ("victims saved", f"{mission.victims_saved} of {mission.num_victims}"),
        *report_rows(mission.finds_reported, mission.mean_report_delay_s, mission.max_report_delay_s),
        ("time", f"{mission.time_s:.1f} s"),
        ("endangered links", str(mission.endangered_links)),
    ]


def _network_rows(network: NetworkFigures, tells_endangered: bool) -> list[tuple[str, str]]:
    all_links = network.num_robots * (network.num_robots - 1) // 2
    rows = [("endangered links", str(network.endangered_links))] if tells_endangered else []
    return [
        *rows,
        ("links endangered for", f"{network.endangered_s:.1f} s"),
        ("links", f"{network.mean_links:.2f} of {all_links} on average, ways of at most {_hops(network.max_hops)}"),
        ("Fiedler value", f"{network.mean_fiedler_value:.3f} on average, at least {network.min_fiedler_value:.3f}"),
        ("team split for", f"{network.split_s:.1f} s"),
    ]


def _robot_table(robots: Sequence[RobotTotals]) -> Table:
    table = Table(box=box.SIMPLE_HEAD)
    table.add_column("robot")
    for name in ("driven\n[m]", "speed\n[m/s]", "fastest\nsecond", "colli-\nsions", "contact\n[s]", "excluded\n[s]"):
        table.add_column(Text(name), justify="right")
    table.add_column("path\nfrom")
    for robot in robots:
        table.add_row(
            robot.name,
            _number(robot.distance_m, ".1f"),
            _number(robot.mean_speed_mps, ".2f"),
            _number(robot.max_speed_mps, ".2f"),
            _number(robot.collisions, "d"),
            _number(robot.contact_s, ".1f"),
            _number(robot.excluded_s, ".1f"),
            robot.source,
        )
    return table


def _cells(figure: RunFigures) -> list[str]:
    mission, network = figure.mission, figure.network
    endangered = mission.endangered_links if mission else network.endangered_links if network else None
    return [
        figure.bag,
        _SHORT_ENDS.get(mission.end, mission.end) if mission else _UNKNOWN,
        f"{mission.areas_explored}/{mission.num_areas}" if mission else _UNKNOWN,
        f"{mission.victims_saved}/{mission.num_victims}" if mission else _UNKNOWN,
        _number(mission.time_s if mission else None, ".1f"),
        _number(endangered, "d"),
        _number(figure.distance_m, ".0f"),
        _number(figure.collisions, "d"),
        _number(network.mean_fiedler_value if network else None, ".2f"),
        _number(network.split_s if network else None, ".1f"),
    ]


def _mean_cells(figures: Sequence[RunFigures]) -> list[str]:
    """Return the means over the bags that tell; a time without a mission is no mission's time."""
    missions = [figure.mission for figure in figures if figure.mission]
    networks = [figure.network for figure in figures if figure.network]
    endangered = [mission.endangered_links for mission in missions]
    distances_m = [figure.distance_m for figure in figures if figure.distance_m is not None]
    collisions = [figure.collisions for figure in figures if figure.collisions is not None]
    return [
        "mean",
        "",
        _mean([mission.areas_explored for mission in missions], ".2f"),
        _mean([mission.victims_saved for mission in missions], ".2f"),
        _mean([mission.time_s for mission in missions], ".1f"),
        _mean(endangered, ".2f"),
        _mean(distances_m, ".0f"),
        _mean(collisions, ".2f"),
        _mean([network.mean_fiedler_value for network in networks], ".2f"),
        _mean([network.split_s for network in networks], ".1f"),
    ]


def _mean(values: Sequence[float], form: str) -> str:
    return _number(statistics.fmean(values) if values else None, form)


def _number(value: float | None, form: str) -> str:
    return _UNKNOWN if value is None else f"{value:{form}}"


def _hops(count: int) -> str:
    return f"{count} hop" if count == 1 else f"{count} hops"


def _end_words(end: str) -> str:
    return next((words for kind, words in END_WORDS.items() if kind == end), end) if end else "not in this bag"


def _print_left_out(console: Console, figures: RunFigures, prefix: str) -> None:
    for line in figures.left_out:
        console.print(Text(f"  {prefix}left out: {line}", style="yellow"), soft_wrap=True)
