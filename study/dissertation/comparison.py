"""Our missions compared with the dissertation's."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from robotteamsim.analysis.report.rank_tests import holm
from robotteamsim.analysis.report.samples import Cell, Sample
from robotteamsim.analysis.report.statistics import Interval, clopper_pearson, fisher_freeman_halton, generator
from study.dissertation.equivalence import Equivalence, equivalence, mean_difference, mean_ratio, median_ratio, sd_ratio

MARGIN = 0.1
"""Relative difference up to which mean and median times count as equivalent."""

SD_FACTOR = 1.5
"""Ratio up to which standard deviations of times count as equivalent."""

VICTIMS_MARGIN = 0.5
"""Difference up to which mean numbers of saved victims count as equivalent."""

RATES: Mapping[float, tuple[int, ...]] = {10.0: (4,), 20.0: (3, 4), 30.0: (3,)}
"""Numbers of saved victims whose rates Table 6 determines best, by noise [dB]."""

_TIME_LIMITS = (1.0 - MARGIN, 1.0 + MARGIN)


@dataclass(frozen=True, slots=True)
class Shares:
    """Share of missions with some property, ours and theirs; each bound is a one-sided exact 95 % bound."""

    ours: Interval
    theirs: Interval


@dataclass(frozen=True, slots=True)
class Comparison:
    """A cell compared with the dissertation's missions; p values have Holm's correction over all cells.

    mean, median, sd: ratios of times, ours over theirs.
    victims:          difference of the mean numbers of saved victims, ours minus theirs.
    victims_p:        p of the Fisher-Freeman-Halton test of the numbers of saved victims.
    rates:            missions that saved at least a number of victims, by that number.
    areas, endangered: missions with all areas explored, and with an endangered link.
    """

    name: str
    noise_db: float
    trials: int
    mean: Equivalence
    median: Equivalence
    sd: Equivalence
    victims: Equivalence
    victims_p: float | None
    rates: Mapping[int, Shares]
    areas: Shares
    endangered: Shares


def compare(pairs: Sequence[tuple[Cell, Sample]]) -> tuple[Comparison, ...]:
    """Compare cells with the dissertation's missions of the same settings."""
    mean, median, sd = (
        _time_ratios(pairs, name, statistic, limits)
        for name, statistic, limits in (
            ("mean", mean_ratio, _TIME_LIMITS),
            ("median", median_ratio, _TIME_LIMITS),
            ("sd", sd_ratio, (1.0 / SD_FACTOR, SD_FACTOR)),
        )
    )
    victims = _corrected(
        [
            equivalence(
                (cell.missions.victims_saved, theirs.victims_saved),
                mean_difference,
                (-VICTIMS_MARGIN, VICTIMS_MARGIN),
                generator("mean victims", cell.name),
            )
            for cell, theirs in pairs
        ]
    )
    counts = holm(
        [
            fisher_freeman_halton([cell.missions.victims_saved, theirs.victims_saved], generator("table", cell.name))
            for cell, theirs in pairs
        ]
    )
    return tuple(
        _comparison(cell, theirs, mean[index], median[index], sd[index], victims[index], counts[index])
        for index, (cell, theirs) in enumerate(pairs)
    )


def shares(ours: np.ndarray, theirs: np.ndarray) -> Shares:
    """Return the shares of missions for which something holds."""
    both = (
        clopper_pearson(int(np.count_nonzero(holds)), len(holds), 0.9)  # Each bound alone has 95 %.
        for holds in (ours, theirs)
    )
    return Shares(*both)


def _comparison(
    cell: Cell,
    theirs: Sample,
    mean: Equivalence,
    median: Equivalence,
    sd: Equivalence,
    victims: Equivalence,
    victims_p: float | None,
) -> Comparison:
    assert cell.scenario is not None
    ours, noise_db = cell.missions, cell.scenario.voice.noise_db
    return Comparison(
        name=cell.name,
        noise_db=noise_db,
        trials=len(ours),
        mean=mean,
        median=median,
        sd=sd,
        victims=victims,
        victims_p=victims_p,
        rates={
            saved: shares(ours.victims_saved >= saved, theirs.victims_saved >= saved)
            for saved in RATES.get(noise_db, ())
        },
        areas=shares(ours.areas_explored == ours.num_areas, theirs.areas_explored == theirs.num_areas),
        endangered=shares(ours.endangered > 0, theirs.endangered > 0),
    )


def _time_ratios(
    pairs: Sequence[tuple[Cell, Sample]], name: str, statistic: Callable[..., np.ndarray], limits: tuple[float, float]
) -> list[Equivalence]:
    return _corrected(
        [
            equivalence(
                (cell.missions.restricted_s, theirs.restricted_s), statistic, limits, generator(name, cell.name)
            )
            for cell, theirs in pairs
        ]
    )


def _corrected(found: Sequence[Equivalence]) -> list[Equivalence]:
    """Return the same with Holm's correction of the p values."""
    p_values = holm([each.p for each in found])
    return [dataclasses.replace(each, p=p) for each, p in zip(found, p_values, strict=True) if p is not None]
