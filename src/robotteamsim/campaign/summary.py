"""Mean, spread and interval of the results of each cell's trials."""

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from robotteamsim.campaign.design import Design
from robotteamsim.campaign.trial import Outcome

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

    settings:   the cell's value of each key of the design.
    trials:     without failed ones.     timed_out: those that ended at the time limit, with that as their time.
    statistics: by name in QUANTITIES, over the trials that have it; DELIVERY_QUANTITIES need a base.
    """

    settings: dict[str, Any]
    trials: int
    failed: int
    timed_out: int
    statistics: dict[str, Spread]


def summarise(design: Design, outcomes: Sequence[Outcome]) -> tuple[CellSummary, ...]:
    """Return the summary of each cell, in the design's order."""
    summaries = []
    for index, cell in enumerate(design.cells):
        own = [outcome for outcome in outcomes if outcome.cell == index]
        good = [outcome for outcome in own if not outcome.failed]
        by_name = {name: [getattr(outcome, name) for outcome in good] for name in QUANTITIES}
        known = {name: [value for value in values if value is not None] for name, values in by_name.items()}
        summaries.append(
            CellSummary(
                settings=dict(zip(design.keys, cell.values, strict=True)),
                trials=len(good),
                failed=len(own) - len(good),
                timed_out=sum(outcome.end == "time_limit" for outcome in good),
                statistics={name: spread(values) for name, values in known.items() if values},
            )
        )
    return tuple(summaries)


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
