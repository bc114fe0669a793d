"""Mean, spread and interval of the results of each cell's trials, also as text: one line per cell."""

import math
import statistics
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from robotteamsim.campaign.design import Design, cell_name, setting_text
from robotteamsim.campaign.trial import Outcome
from robotteamsim.wording import column_groups, counted

UNLIMITED = 10**9
"""Width of a table that is not for a terminal."""

_MAX_COPIES = 8
"""Number of cells that a note lists."""

DELIVERY_QUANTITIES = ("discoveries_delivered", "mean_delivery_delay_s", "max_delivery_delay_s")
QUANTITIES = (
    *("victims_saved", "time_s", "areas_explored", "endangered_links", "distance_m", "contact_s"),
    *DELIVERY_QUANTITIES,
)


@dataclass(frozen=True, slots=True)
class Spread:
    """Mean, sample standard deviation, and Student's 95 % interval of the mean of one quantity in one cell.

    sd, low and high are None for fewer than two trials.
    """

    mean: float
    sd: float | None
    low: float | None
    high: float | None


@dataclass(frozen=True, slots=True)
class CellSummary:
    """The results of a cell's trials.

    name:       its settings in short, see `cell_name`.
    settings:   the cell's value of each key of the design.
    trials:     without failed ones.     timed_out: those that ended at the time limit, with that as their time.
    controllers_failed: trials in which a controller was stopped, so that its robot stood still.
    different:  number of different trajectories; below `trials` if missions of the cell are copies of each other.
    statistics: by name in QUANTITIES, over the trials that have it; DELIVERY_QUANTITIES need a base.
    """

    name: str
    settings: dict[str, Any]
    trials: int
    failed: int
    timed_out: int
    controllers_failed: int
    different: int
    statistics: dict[str, Spread]


def summarise(design: Design, outcomes: Sequence[Outcome]) -> tuple[CellSummary, ...]:
    """Return the summary of each cell, in the design's order."""
    summaries = []
    for index, cell in enumerate(design.cells):
        settings = dict(zip(design.keys, cell.values, strict=True))
        own = [outcome for outcome in outcomes if outcome.cell == index]
        good = [outcome for outcome in own if not outcome.failed]
        by_name = {name: [getattr(outcome, name) for outcome in good] for name in QUANTITIES}
        known = {name: [value for value in values if value is not None] for name, values in by_name.items()}
        summaries.append(
            CellSummary(
                name=cell_name(settings, design.scenario.name),
                settings=settings,
                trials=len(good),
                failed=len(own) - len(good),
                timed_out=sum(outcome.end == "time_limit" for outcome in good),
                controllers_failed=sum(bool(outcome.controller_failed) for outcome in good),
                different=num_different(good),
                statistics={name: spread(values) for name, values in known.items() if values},
            )
        )
    return tuple(summaries)


def num_different(outcomes: Sequence[Outcome]) -> int:
    """Return the number of different trajectories of missions that have ended."""
    return len({outcome.trajectory_hash for outcome in outcomes})


def copies_note(cells: Iterable[tuple[str, int, int]]) -> str:
    """Return a note about cells in which missions have the same trajectories; "" if there are none.

    Args: cells: name, number of missions and of different trajectories of each cell.
    """
    listed = [
        f"{name}: {counted(missions, 'mission')}, {different} different"
        for name, missions, different in cells
        if different < missions
    ]
    if not listed:
        return ""
    more = f"; and {counted(len(listed) - _MAX_COPIES, 'more setting')}" if len(listed) > _MAX_COPIES else ""
    return (
        "Identical missions: robots drove the same trajectories with several seeds. Means and intervals count each of "
        f"these missions, so the intervals are too narrow. {'; '.join(listed[:_MAX_COPIES])}{more}."
    )


def spread(values: Sequence[float]) -> Spread:
    """Return mean, standard deviation and interval. Raises: ValueError: there are no values."""
    if not values:
        raise ValueError("values must not be empty")
    mean = statistics.fmean(values)
    if len(values) < 2:
        return Spread(mean, None, None, None)
    from scipy import stats  # Slow to import.

    sd = statistics.stdev(values)
    half = float(stats.t.ppf(0.975, len(values) - 1)) * sd / math.sqrt(len(values))
    return Spread(mean, sd, mean - half, mean + half)


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
        values = [setting_text(value) for value in summary.settings.values()]
        count = f"{summary.trials}" + (f" + {summary.failed} failed" if summary.failed else "")
        count += f" ({summary.controllers_failed} with failed controllers)" if summary.controllers_failed else ""
        spreads = [summary.statistics.get(name) for name in columns.values()]
        lines.append([*values, count, *(_spread(spread) for spread in spreads)])
    text = "Mean, standard deviation, 95 % interval of the mean\n\n" + aligned(lines, len(design.keys) + 1, width)
    timed_out = sum(summary.timed_out for summary in summaries)
    ended = f"{counted(timed_out, 'mission')} ended at the time limit, which counts as the duration"
    return f"{text}\n\n{ended}" if timed_out else text


def controllers_note(outcomes: Sequence[Outcome]) -> str:
    """Return a note about missions in which a controller failed, with the first reason; "" if there are none."""
    failed = [outcome for outcome in outcomes if outcome.controller_failed]
    if not failed:
        return ""
    first = failed[0]
    return (
        f"In {len(failed)} of {counted(len(outcomes), 'mission')} a controller failed; the first: seed {first.seed}, "
        f"{first.controller_failed}"
    )


def exclusion_note(outcomes: Sequence[Outcome]) -> str:
    """Return a note about missions that ended because all robots were excluded; "" if there are none."""
    times_s = [outcome.time_s for outcome in outcomes if outcome.end == "all_excluded" and outcome.time_s is not None]
    if not times_s:
        return ""
    when = f"{min(times_s):.0f}" if len(times_s) == 1 else f"{min(times_s):.0f} to {max(times_s):.0f}"
    return (
        f"{counted(len(times_s), 'mission')} ended at {when} s because all robots were excluded; that is the "
        "time here, while a report uses the time limit"
    )


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


def _spread(spread: Spread | None) -> str:
    if spread is None:
        return "-"
    if spread.sd is None:
        return f"{spread.mean:.2f}"
    return f"{spread.mean:.2f} ± {spread.sd:.2f} [{spread.low:.2f}, {spread.high:.2f}]"
