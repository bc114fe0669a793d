"""Tables as text: Tables 6 to 9 with our values and the dissertation's, and one line per cell of other campaigns."""

import dataclasses
import json
import statistics
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from robotteamsim.campaign.design import Design
from robotteamsim.campaign.reference import MissionValues, dissertation_missions
from robotteamsim.campaign.summary import DELIVERY_QUANTITIES, CellSummary, Spread
from robotteamsim.campaign.trial import Outcome
from robotteamsim.wording import column_groups, counted

Missions = Mapping[float, Sequence[MissionValues | None]]
"""Missions by background noise [dB], in order; None for one that failed or was not run."""

_NOISE_KEY = "voice.noise_db"
_SHOWN_TRIALS = 30
_NAME_WIDTH = 6
UNLIMITED = 10**9
"""Width of a table that is not for a terminal."""
_Column = tuple[str, int, Callable[[MissionValues], float], int]
_VICTIMS: _Column = ("victims saved", 7, lambda values: values.victims_saved, 1)
_TIME: _Column = ("time [s]", 7, lambda values: round(values.time_s), 1)
_AREAS: _Column = ("waypoints", 6, lambda values: values.areas_explored, 2)
_ENDANGERED: _Column = ("endangered", 6, lambda values: values.endangered_links, 2)
_STATISTICS: dict[str, Callable[[list[float]], float]] = {
    "Mean": statistics.fmean,
    "Median": statistics.median,
    "Mode": lambda values: min(statistics.multimode(values)),  # of ties the smallest, as in Table 8: 348 s, not 350 s
}


def is_the_dissertations(design: Design) -> bool:
    """Whether Tables 6 to 9 apply to a campaign: the garage, and only the noise varies."""
    return design.scenario.name == "garage_sar" and design.keys == (_NOISE_KEY,)


def missions_by_noise(design: Design, outcomes: Sequence[Outcome]) -> Missions:
    """Return our missions in the form of the dissertation, for a design that varies only the noise."""
    missions: dict[float, list[MissionValues | None]] = {
        cell.values[0]: [None] * design.trials for cell in design.cells
    }
    for outcome in outcomes:
        if not outcome.failed:
            values = MissionValues(*(getattr(outcome, field.name) for field in dataclasses.fields(MissionValues)))
            missions[design.cells[outcome.cell].values[0]][outcome.number - 1] = values
    return missions


def dissertation_tables(ours: Missions, width: int = UNLIMITED) -> str:
    """Return Tables 6 to 9 for our noise levels, each value next to the dissertation's if it has that level.

    Times are whole seconds, as in the dissertation. Noise levels that do not fit into the width come below.
    """
    theirs = dissertation_missions()
    levels = sorted(ours)
    columns = [sum(2 * column for _, column, _, _ in (_VICTIMS, _TIME)) + 2] * len(levels)
    blocks = []
    for group in column_groups(columns, _NAME_WIDTH, width + 2):
        some = {levels[index]: ours[levels[index]] for index in group}
        blocks.append(
            [
                _raw_table("Table 6: victims saved and duration of each mission", some, theirs, _VICTIMS, _TIME),
                _raw_table(
                    "Table 7: waypoints explored, times a connection was endangered", some, theirs, _AREAS, _ENDANGERED
                ),
                _statistics_table("Table 8: mean, median and mode of Table 6", some, theirs, _VICTIMS, _TIME),
                _statistics_table("Table 9: mean, median and mode of Table 7", some, theirs, _AREAS, _ENDANGERED),
            ]
        )
    return "\n\n".join(table for tables in zip(*blocks, strict=True) for table in tables)


def summary_table(design: Design, summaries: Sequence[CellSummary], width: int = UNLIMITED) -> str:
    """Return one line per cell: its settings; mean, standard deviation and 95 % interval of its results.

    With a base, also the number of discoveries delivered to it, and their mean and longest delay. Results that do not
    fit into the width come below.
    """
    columns = {"victims saved": "victims_saved", "time [s]": "time_s", "areas": "areas_explored"}
    columns |= {"endangered": "endangered_links", "driven [m]": "distance_m"}
    if design.scenario.base is not None:
        columns |= dict(zip(("delivered", "mean delay [s]", "max delay [s]"), DELIVERY_QUANTITIES, strict=True))
    lines = [[*design.keys, "trials", *columns]]
    for summary in summaries:
        values = [_setting(value) for value in summary.settings.values()]
        count = f"{summary.trials}" + (f" + {summary.failed} failed" if summary.failed else "")
        spreads = [summary.statistics.get(name) for name in columns.values()]
        lines.append([*values, count, *(_spread(spread) for spread in spreads)])
    text = "Mean, standard deviation, 95 % interval of the mean\n\n" + aligned(lines, len(design.keys) + 1, width)
    timed_out = sum(summary.timed_out for summary in summaries)
    ended = f"{counted(timed_out, 'mission')} ended at the time limit, which counts as the duration"
    return f"{text}\n\n{ended}" if timed_out else text


def exclusion_note(outcomes: Sequence[Outcome]) -> str:
    """Return a note about missions that ended because all robots were excluded; "" if there are none."""
    times_s = [outcome.time_s for outcome in outcomes if outcome.end == "all_excluded" and outcome.time_s is not None]
    if not times_s:
        return ""
    when = f"{min(times_s):.0f}" if len(times_s) == 1 else f"{min(times_s):.0f} to {max(times_s):.0f}"
    return (
        f"{counted(len(times_s), 'mission')} of ours ended at {when} s because all robots were excluded; that is the "
        "time here, while a report uses the time limit"
    )


def _raw_table(title: str, ours: Missions, theirs: Missions, *columns: _Column) -> str:
    """One line per mission."""
    num_ours = max(len(missions) for missions in ours.values())
    num_lines = min(_SHOWN_TRIALS, max(num_ours, _SHOWN_TRIALS if set(ours) & set(theirs) else 0))
    lines = []
    for index in range(num_lines):
        cells = [str(index + 1)]
        for noise_db in sorted(ours):
            pair = [_item(source.get(noise_db, ()), index) for source in (ours, theirs)]
            for _, _, value, _ in columns:
                cells += ["-" if mission is None else f"{value(mission):g}" for mission in pair]
        lines.append(cells)
    table = _block(title, "Trial", sorted(ours), columns, lines)
    more = num_ours - num_lines
    return table + (f"\nand {more} more of ours in trials.csv" if more > 0 else "")


def _statistics_table(title: str, ours: Missions, theirs: Missions, *columns: _Column) -> str:
    """One line each for mean, median and mode."""
    lines = []
    for name, statistic in _STATISTICS.items():
        cells = [name]
        for noise_db in sorted(ours):
            for _, _, value, digits in columns:
                for source in (ours, theirs):
                    values = [float(value(mission)) for mission in source.get(noise_db, ()) if mission is not None]
                    cells.append(f"{statistic(values):.{digits}f}".rstrip("0").rstrip(".") if values else "-")
        lines.append(cells)
    return _block(title, "", sorted(ours), columns, lines)


def _block(
    title: str, corner: str, noises_db: Sequence[float], columns: Sequence[_Column], lines: Sequence[Sequence[str]]
) -> str:
    """Format a table with each column twice under each noise: ours, and the dissertation's as "diss."."""
    widths = [width for _, width, _, _ in columns for _ in ("ours", "diss.")]
    heads = [
        [f"{noise_db:g} dB".center(sum(widths)) for noise_db in noises_db],
        ["".join(f"{name:>{2 * width}}" for name, width, _, _ in columns)] * len(noises_db),
        [_row(("ours", "diss.") * len(columns), widths)] * len(noises_db),
    ]
    rows = [
        [_row(cells[start : start + len(widths)], widths) for start in range(1, len(cells), len(widths))]
        for cells in lines
    ]
    names = [corner, "", "", *(cells[0] for cells in lines)]
    table = [f"{name:{_NAME_WIDTH}}" + "  ".join(levels) for name, levels in zip(names, [*heads, *rows], strict=True)]
    return "\n".join([title, *(line.rstrip() for line in table)])


def _row(cells: Sequence[str], widths: Sequence[int]) -> str:
    return "".join(f"{cell:>{width}}" for cell, width in zip(cells, widths, strict=True))


def aligned(lines: Sequence[Sequence[str]], num_first: int, total_width: int) -> str:
    """Return lines of equal length as aligned columns; groups of columns that fit the width repeat the first ones."""
    widths = [max(len(line[column]) for line in lines) for column in range(len(lines[0]))]
    first_width = sum(widths[:num_first]) + 2 * (num_first - 1)
    blocks = []
    for group in column_groups([2 + width for width in widths[num_first:]], first_width, total_width):
        columns = [*range(num_first), *(num_first + index for index in group)]
        padded = ["  ".join(f"{line[column]:<{widths[column]}}" for column in columns) for line in lines]
        blocks.append("\n".join(line.rstrip() for line in padded))
    return "\n\n".join(blocks)


def _item(missions: Sequence[MissionValues | None], index: int) -> MissionValues | None:
    return missions[index] if index < len(missions) else None


def _setting(value: Any) -> str:
    text = value if isinstance(value, str) else json.dumps(value)
    return text if len(text) <= 30 else f"{text[:27]}..."


def _spread(spread: Spread | None) -> str:
    if spread is None:
        return "-"
    if spread.sd is None:
        return f"{spread.mean:.2f}"
    return f"{spread.mean:.2f} ± {spread.sd:.2f} [{spread.low:.2f}, {spread.high:.2f}]"
