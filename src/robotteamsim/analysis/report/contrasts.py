"""Settings compared in pairs, as the cells of a campaign: effect sizes, intervals of differences, and tests."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

import numpy as np

from robotteamsim.analysis.report.rank_tests import (
    holm,
    kruskal_wallis,
    mann_whitney,
    mean_shift,
    superiority,
    wilcoxon,
)
from robotteamsim.analysis.report.samples import Campaign, Cell, Sample
from robotteamsim.analysis.report.statistics import Interval, fisher_freeman_halton, generator
from robotteamsim.campaign.design import cell_name

ALGORITHM_KEY = "control.algorithm"

MAX_PAIRS = 66
"""Most pairs that a reader gets without asking."""

_QUANTITIES: dict[str, tuple[int, Callable[[Sample], np.ndarray]]] = {
    "victims saved": (2, lambda sample: sample.victims_saved),
    "time [s]": (1, lambda sample: sample.restricted_s),
    "areas explored": (2, lambda sample: sample.areas_explored),
    "endangered links": (2, lambda sample: sample.endangered),
    "driven [m]": (0, lambda sample: sample.distance_m),
}
"""By name, the decimals shown and the values."""


class Numbered(Protocol):
    """Missions with the numbers of their trials; in paired samples, those of equal number form a pair."""

    @property
    def numbers(self) -> np.ndarray:
        """Shape (missions,)."""


Missions = TypeVar("Missions", bound=Numbered)


@dataclass(frozen=True, slots=True)
class Pair(Generic[Missions]):
    """Two samples to compare. where: settings that both have, or "". names: what distinguishes them."""

    where: str
    names: tuple[str, str]
    first: Missions
    second: Missions


@dataclass(frozen=True, slots=True)
class Contrast:
    """The difference between two samples in one quantity.

    where, first, second: as `where` and `names` of `Pair`.
    difference:  of the means, second minus first, with its 95 % interval.
    superiority: probability that a mission of the second has the larger value; ties count half.
    p:           of Mann-Whitney's or, in pairs, Wilcoxon's test, with Holm's correction over all pairs of samples; None
                 if there is nothing to test.
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


def compared_pairs(campaign: Campaign, *, each_pair: bool = False) -> list[Pair[Sample]]:
    """Return the cells to compare, in pairs.

    If algorithms are compared, each with the first one under equal other settings; otherwise each cell with each other.
    Args: each_pair: each algorithm with each other.
    """
    return _algorithm_pairs(campaign, each_pair) or _all_pairs(campaign.cells)


def contrasts(campaign: Campaign, *, each_pair: bool = False) -> tuple[Contrast, ...]:
    """Compare pairs of cells in each quantity in which they differ.

    Args: each_pair: see `compared_pairs`; then also of more than MAX_PAIRS.
    """
    pairs = compared_pairs(campaign, each_pair=each_pair)
    if not pairs or (len(pairs) > MAX_PAIRS and not each_pair):
        return ()
    found = [
        compare(pairs, quantity, decimals, of, campaign.paired)
        for quantity, (decimals, of) in _QUANTITIES.items()
        if _differ(pairs, of, campaign.paired)
    ]
    return tuple(contrast for of_pair in zip(*found, strict=True) for contrast in of_pair if contrast)


def compare(
    pairs: Sequence[Pair[Missions]],
    quantity: str,
    decimals: int,
    of: Callable[[Missions], np.ndarray],
    paired: bool,
    ranked: Callable[[Missions], np.ndarray] | None = None,
) -> list[Contrast | None]:
    """Return the contrast of each pair in one quantity; None if one of its samples has no mission to compare.

    Args: ranked: values for the tests, which only their ranks enter, where they are others than those for the means.
    """
    values = [_values(pair, of, paired) for pair in pairs]
    tested = values if ranked is None else [_values(pair, ranked, paired) for pair in pairs]
    p_values = holm([wilcoxon(a, b) if paired else mann_whitney(a, b) for a, b in tested])
    return [
        Contrast(
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
        if len(a) and len(b)
        else None
        for pair, (a, b), p in zip(pairs, values, p_values, strict=True)
    ]


def overall(campaign: Campaign) -> Overall | None:
    """Test whether any cells differ; None for a single cell."""
    samples = [cell.missions for cell in campaign.cells]
    if len(samples) < 2:
        return None
    return Overall(
        time_p=kruskal_wallis([sample.restricted_s for sample in samples], generator("cells", "time")),
        victims_p=fisher_freeman_halton([s.victims_saved for s in samples], generator("cells", "victims")),
        areas_p=fisher_freeman_halton([s.areas_explored for s in samples], generator("cells", "areas")),
    )


def _algorithm_pairs(campaign: Campaign, each_pair: bool) -> list[Pair[Sample]]:
    """Return pairs of algorithms under equal other settings; [] if only one algorithm is there."""
    if ALGORITHM_KEY not in campaign.keys:
        return []
    known = list(dict.fromkeys(cell.settings[ALGORITHM_KEY] for cell in campaign.cells))
    compared = list(itertools.combinations(known, 2)) if each_pair else [(known[0], other) for other in known[1:]]
    pairs = []
    for first, second in itertools.permutations(campaign.cells, 2):
        algorithms = first.settings[ALGORITHM_KEY], second.settings[ALGORITHM_KEY]
        if algorithms in compared and _others(first) == _others(second):
            where = cell_name(_others(first), campaign.scenario.name) if len(campaign.keys) > 1 else ""
            pairs.append(Pair(where, algorithms, first.missions, second.missions))
    return pairs


def _others(cell: Cell) -> dict[str, object]:
    return {key: value for key, value in cell.settings.items() if key != ALGORITHM_KEY}


def _all_pairs(cells: Sequence[Cell]) -> list[Pair[Sample]]:
    return [Pair("", (a.name, b.name), a.missions, b.missions) for a, b in itertools.combinations(cells, 2)]


def _differ(pairs: Sequence[Pair[Sample]], of: Callable[[Sample], np.ndarray], paired: bool) -> bool:
    """Whether the values of all pairs are known and not all equal."""
    joined = np.concatenate([values for pair in pairs for values in _values(pair, of, paired)])
    return bool(len(joined)) and not np.isnan(joined).any() and np.ptp(joined) > 0


def _values(pair: Pair[Missions], of: Callable[[Missions], np.ndarray], paired: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return the values of both samples; of paired ones those of trials that both have, in the same order."""
    a, b = of(pair.first), of(pair.second)
    if not paired:
        return a, b
    _, in_a, in_b = np.intersect1d(pair.first.numbers, pair.second.numbers, return_indices=True)
    return a[in_a], b[in_b]
