"""Mean, spread and interval of what the trials of each cell gave."""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from robotteamsim.campaign.design import Design
from robotteamsim.campaign.trial import Outcome

REPORTS = ("finds_reported", "mean_report_delay_s", "max_report_delay_s")
FIGURES = ("victims_saved", "time_s", "areas_explored", "endangered_links", "distance_m", "contact_s", *REPORTS)


@dataclass(frozen=True, slots=True)
class Spread:
    """Of one figure in one cell: mean, sample standard deviation, and Student's 95 % interval of the mean.

    sd, low and high are none where there are fewer than two trials.
    """

    mean: float
    sd: float | None
    low: float | None
    high: float | None


@dataclass(frozen=True, slots=True)
class CellSummary:
    """What the trials of a cell gave.

    settings:   the cell's value of each key of the design.
    trials:     without failed ones.     timed_out: those of them that ended at the time limit; their time counts as is.
    figures:    of each of FIGURES that some trial has, over those that have it; those of REPORTS need a base.
    """

    settings: dict[str, Any]
    trials: int
    failed: int
    timed_out: int
    figures: dict[str, Spread]

    def as_json(self) -> dict[str, Any]:
        """Return it as plain values."""
        return asdict(self)


def summarise(design: Design, outcomes: Sequence[Outcome]) -> tuple[CellSummary, ...]:
    """Return the summary of each cell, in the design's order."""
    summaries = []
    for index, cell in enumerate(design.cells):
        own = [outcome for outcome in outcomes if outcome.cell == index]
        good = [outcome for outcome in own if not outcome.failed]
        known = {name: [v for v in (getattr(outcome, name) for outcome in good) if v is not None] for name in FIGURES}
        figures = {name: spread(values) for name, values in known.items() if values}
        summaries.append(
            CellSummary(
                settings=dict(zip(design.keys, cell.values, strict=True)),
                trials=len(good),
                failed=len(own) - len(good),
                timed_out=sum(outcome.end == "time_limit" for outcome in good),
                figures=figures,
            )
        )
    return tuple(summaries)


def spread(values: Sequence[float]) -> Spread:
    """Return mean, standard deviation and interval. Raises: ValueError: there are no values."""
    if not values:
        raise ValueError("no values have no mean")
    mean = statistics.fmean(values)
    if len(values) < 2:
        return Spread(mean, None, None, None)
    from scipy import stats  # Takes longer to import than this module is used.

    sd = statistics.stdev(values)
    half = float(stats.t.ppf(0.975, len(values) - 1)) * sd / math.sqrt(len(values))
    return Spread(mean, sd, mean - half, mean + half)
