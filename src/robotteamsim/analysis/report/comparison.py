"""The statistics of a report: intervals of each cell, tests between cells and against the dissertation's missions."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from robotteamsim import rng
from robotteamsim.analysis.report.samples import Campaign, Sample
from robotteamsim.analysis.report.statistics import (
    Interval,
    Ratio,
    bootstrap_mean,
    clopper_pearson,
    fisher_freeman_halton,
    holm,
    kruskal_wallis,
    mann_whitney,
    mean_ratio,
)

MARGIN = 0.1
"""Relative difference up to which mean times count as equivalent."""

_SEED = 2013
_MAX_PAIRS = 66


@dataclass(frozen=True, slots=True)
class Means:
    """Bootstrap means of a sample: time to finish, up to the limit [s]; victims saved; areas explored."""

    time_s: Interval
    victims: Interval
    areas: Interval


@dataclass(frozen=True, slots=True)
class Rate:
    """Share of missions that saved at least `saved` victims: ours and theirs, with Clopper-Pearson intervals."""

    saved: int
    ours: Interval
    theirs: Interval


@dataclass(frozen=True, slots=True)
class Comparison:
    """A cell compared with the dissertation's missions.

    time:               ratio of mean times.
    time_p, victims_p:  p of the equivalence test and of the Fisher-Freeman-Halton test, Holm-corrected over all cells.
    areas, endangered:  shares of missions with all areas explored, and with an endangered link: ours, theirs.
    """

    name: str
    noise_db: float
    trials: int
    time: Ratio
    time_p: float
    victims_p: float | None
    rates: tuple[Rate, ...]
    areas: tuple[Interval, Interval]
    endangered: tuple[Interval, Interval]


@dataclass(frozen=True, slots=True)
class Pair:
    """A Mann-Whitney test of two cells' times; p is Holm-corrected over all pairs."""

    first: str
    second: str
    p: float | None


@dataclass(frozen=True, slots=True)
class Differences:
    """Tests between our own cells: Kruskal-Wallis of times, Fisher-Freeman-Halton of victims and of areas."""

    time_p: float | None
    victims_p: float | None
    areas_p: float | None
    pairs: tuple[Pair, ...]


RATES: Mapping[float, tuple[int, ...]] = {10.0: (4,), 20.0: (3, 4), 30.0: (3,)}
"""Numbers of saved victims whose rates Table 6 determines best, by noise [dB]."""


def generator(*name: str | int) -> np.random.Generator:
    """Return the random generator of one computation, so that the same store gives the same report."""
    return rng.stream(_SEED, "report", *name)


def means(sample: Sample, name: str) -> Means:
    """Return the means of a sample; `name` names its random stream."""
    return Means(
        bootstrap_mean(sample.restricted_s, generator("time", name)),
        bootstrap_mean(sample.victims_saved.astype(float), generator("victims", name)),
        bootstrap_mean(sample.areas_explored.astype(float), generator("areas", name)),
    )


def compare(campaign: Campaign) -> tuple[Comparison, ...]:
    """Compare each cell that the dissertation also has with the dissertation's missions."""
    pairs = campaign.compared
    times = [
        mean_ratio(cell.ours.restricted_s, theirs.restricted_s, MARGIN, generator("ratio", cell.name))
        for cell, theirs in pairs
    ]
    victims = [
        fisher_freeman_halton([cell.ours.victims_saved, theirs.victims_saved], generator("table", cell.name))
        for cell, theirs in pairs
    ]
    comparisons = []
    for (cell, theirs), time, time_p, victims_p in zip(
        pairs, times, holm([time.p for time in times]), holm(victims), strict=True
    ):
        assert cell.scenario is not None
        assert time_p is not None
        noise_db = cell.scenario.voice.noise_db
        rates = (
            Rate(saved, _share(cell.ours.victims_saved >= saved), _share(theirs.victims_saved >= saved))
            for saved in RATES.get(noise_db, ())
        )
        areas = [_share(sample.areas_explored == sample.num_areas) for sample in (cell.ours, theirs)]
        endangered = [_share(sample.endangered > 0) for sample in (cell.ours, theirs)]
        comparisons.append(
            Comparison(
                name=cell.name,
                noise_db=noise_db,
                trials=len(cell.ours),
                time=time,
                time_p=time_p,
                victims_p=victims_p,
                rates=tuple(rates),
                areas=(areas[0], areas[1]),
                endangered=(endangered[0], endangered[1]),
            )
        )
    return tuple(comparisons)


def differences(campaign: Campaign) -> Differences | None:
    """Test whether our cells differ; None for a single cell. Pairs are omitted if there are too many to read."""
    cells = campaign.cells
    if len(cells) < 2:
        return None
    pairs = list(itertools.combinations(cells, 2))
    pairs = pairs if len(pairs) <= _MAX_PAIRS else []
    p_values = holm([mann_whitney(a.ours.restricted_s, b.ours.restricted_s) for a, b in pairs])
    return Differences(
        time_p=kruskal_wallis([cell.ours.restricted_s for cell in cells]),
        victims_p=fisher_freeman_halton([cell.ours.victims_saved for cell in cells], generator("cells", "victims")),
        areas_p=fisher_freeman_halton([cell.ours.areas_explored for cell in cells], generator("cells", "areas")),
        pairs=tuple(Pair(a.name, b.name, p) for (a, b), p in zip(pairs, p_values, strict=True)),
    )


def _share(holds: np.ndarray) -> Interval:
    return clopper_pearson(int(np.count_nonzero(holds)), len(holds))
