"""Our cells compared with each other: effect sizes, intervals of differences, and tests."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from robotteamsim.analysis.report.comparison import generator
from robotteamsim.analysis.report.rank_tests import (
    holm,
    kruskal_wallis,
    mann_whitney,
    mean_shift,
    superiority,
    wilcoxon,
)
from robotteamsim.analysis.report.samples import Campaign, Cell, Sample, cell_name
from robotteamsim.analysis.report.statistics import Interval, fisher_freeman_halton

ALGORITHM_KEY = "control.algorithm"

_MAX_PAIRS = 66
_QUANTITIES: dict[str, tuple[int, Callable[[Sample], np.ndarray]]] = {
    "victims saved": (2, lambda sample: sample.victims_saved),
    "time [s]": (1, lambda sample: sample.restricted_s),
    "areas explored": (2, lambda sample: sample.areas_explored),
    "endangered links": (2, lambda sample: sample.endangered),
    "driven [m]": (0, lambda sample: sample.distance_m),
}
"""By name, the decimals shown and the values."""


@dataclass(frozen=True, slots=True)
class Contrast:
    """The difference between two cells in one quantity.

    where:       settings that both have, or "".    first, second: what distinguishes them.
    difference:  of the means, second minus first, with its 95 % interval.
    superiority: probability that a mission of the second has the larger value; ties count half.
    p:           of Mann-Whitney's or, in pairs, Wilcoxon's test, with Holm's correction over all pairs of cells.
    pairs:       number of pairs with the same seed; None if the missions are independent.
    """

    where: str
    first: str
    second: str
    quantity: str
    decimals: int
    values: tuple[float, float]
    difference: Interval
    superiority: float
    p: float | None
    pairs: int | None


@dataclass(frozen=True, slots=True)
class Overall:
    """Tests of all cells at once: Kruskal-Wallis of times, Fisher-Freeman-Halton of victims and of areas."""

    time_p: float | None
    victims_p: float | None
    areas_p: float | None


@dataclass(frozen=True, slots=True)
class _Pair:
    where: str
    first: Cell
    second: Cell
    names: tuple[str, str]


def contrasts(campaign: Campaign) -> tuple[Contrast, ...]:
    """Compare cells in pairs; none if there are too many pairs to read.

    If algorithms are compared, each is compared with the first one under equal other settings. Otherwise each cell is
    compared with each other one.
    """
    pairs = _algorithm_pairs(campaign) or _all_pairs(campaign.cells)
    if not 0 < len(pairs) <= _MAX_PAIRS:
        return ()
    found = [
        numbered
        for quantity, (decimals, of) in _QUANTITIES.items()
        for numbered in _contrasts(pairs, quantity, decimals, of, campaign.paired)
    ]
    return tuple(contrast for _, contrast in sorted(found, key=lambda numbered: numbered[0]))


def overall(campaign: Campaign) -> Overall | None:
    """Test whether any of our cells differ; None for a single cell."""
    samples = [cell.ours for cell in campaign.cells]
    if len(samples) < 2:
        return None
    return Overall(
        time_p=kruskal_wallis([sample.restricted_s for sample in samples], generator("cells", "time")),
        victims_p=fisher_freeman_halton([s.victims_saved for s in samples], generator("cells", "victims")),
        areas_p=fisher_freeman_halton([s.areas_explored for s in samples], generator("cells", "areas")),
    )


def _algorithm_pairs(campaign: Campaign) -> list[_Pair]:
    """Return the first algorithm and each other one, under equal other settings; [] if only one algorithm is there."""
    if ALGORITHM_KEY not in campaign.keys:
        return []
    baseline = campaign.cells[0].settings[ALGORITHM_KEY]
    pairs = []
    for first, second in itertools.permutations(campaign.cells, 2):
        algorithms = first.settings[ALGORITHM_KEY], second.settings[ALGORITHM_KEY]
        if algorithms[0] == baseline != algorithms[1] and _others(first) == _others(second):
            where = cell_name(_others(first), campaign.scenario) if len(campaign.keys) > 1 else ""
            pairs.append(_Pair(where, first, second, algorithms))
    return pairs


def _others(cell: Cell) -> dict[str, object]:
    return {key: value for key, value in cell.settings.items() if key != ALGORITHM_KEY}


def _all_pairs(cells: Sequence[Cell]) -> list[_Pair]:
    return [_Pair("", a, b, (a.name, b.name)) for a, b in itertools.combinations(cells, 2)]


def _contrasts(
    pairs: Sequence[_Pair], quantity: str, decimals: int, of: Callable[[Sample], np.ndarray], paired: bool
) -> list[tuple[int, Contrast]]:
    """Return the contrasts of one quantity with the pairs' indices; [] if all values are equal, or unknown."""
    values = [_matched(pair, of) if paired else (of(pair.first.ours), of(pair.second.ours)) for pair in pairs]
    joined = np.concatenate([each for both in values for each in both])
    if not len(joined) or np.isnan(joined).any() or np.ptp(joined) == 0:
        return []
    p_values = holm([wilcoxon(a, b) if paired else mann_whitney(a, b) for a, b in values])
    found = []
    for index, (pair, (a, b), p) in enumerate(zip(pairs, values, p_values, strict=True)):
        if not (len(a) and len(b)):
            continue
        contrast = Contrast(
            where=pair.where,
            first=pair.names[0],
            second=pair.names[1],
            quantity=quantity,
            decimals=decimals,
            values=(float(np.mean(a)), float(np.mean(b))),
            difference=mean_shift(a, b, paired),
            superiority=superiority(a, b, paired),
            p=p,
            pairs=len(a) if paired else None,
        )
        found.append((index, contrast))
    return found


def _matched(pair: _Pair, of: Callable[[Sample], np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Return the values of trials that both cells have, in the same order."""
    a, b = pair.first.ours, pair.second.ours
    _, in_a, in_b = np.intersect1d(a.numbers, b.numbers, return_indices=True)
    return of(a)[in_a], of(b)[in_b]
