"""Confidence intervals, tests of counts, and survival curves, computed by SciPy and statsmodels."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats
from statsmodels.stats.proportion import proportion_confint

from robotteamsim import rng

RESAMPLES = 9_999
"""Number of resamples of a bootstrap."""

TABLES = 99_999
"""Number of random tables of a Fisher-Freeman-Halton test; a tenth of it for large tables."""

BATCH = 1_000
"""Resamples that are computed at once."""

_BAND_RESAMPLES = 1_999
_BAND_POINTS = 200
_SEED = 2013
_LARGE_TABLE = 60
_TIE = 1e-9


@dataclass(frozen=True, slots=True)
class Interval:
    """An estimate with its confidence bounds."""

    value: float
    low: float
    high: float


@dataclass(frozen=True, slots=True, eq=False)
class Survival:
    """Share of missions still running at each time, with a pointwise 95 % interval; arrays of equal shape."""

    time_s: np.ndarray
    share: np.ndarray
    low: np.ndarray
    high: np.ndarray
    censored_s: np.ndarray


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """A mean over time with a pointwise 95 % interval, NaN for a single mission; arrays of equal shape."""

    time_s: np.ndarray
    mean: np.ndarray
    low: np.ndarray
    high: np.ndarray


def generator(*name: str | int) -> np.random.Generator:
    """Return the random generator of one computation, so that the same store gives the same report."""
    return rng.stream(_SEED, "report", *name)


def clopper_pearson(successes: int, count: int, confidence: float = 0.95) -> Interval:
    """Return a share with its exact interval. Raises: ValueError: count is below 1."""
    if count < 1:
        raise ValueError("count must be at least 1")
    low, high = proportion_confint(successes, count, alpha=1.0 - confidence, method="beta")
    # At 0 and 1, statsmodels returns NaN or a value outside by a rounding error.
    low = 0.0 if successes == 0 else float(low)
    high = 1.0 if successes == count else float(high)
    return Interval(successes / count, low, high)


def bootstrap_mean(values: np.ndarray, generator: np.random.Generator) -> Interval:
    """Return the mean with its 95 % percentile bootstrap interval, which has zero width for equal or single values."""
    mean = float(np.mean(values))
    if len(values) < 2 or np.ptp(values) == 0:
        return Interval(mean, mean, mean)
    result = stats.bootstrap(
        (values,),
        np.mean,
        n_resamples=RESAMPLES,
        batch=BATCH,
        confidence_level=0.95,
        method="percentile",
        rng=generator,
    )
    low, high = result.confidence_interval
    return Interval(mean, float(low), float(high))


def mean_course(events_s: Sequence[Sequence[float]], until_s: float, generator: np.random.Generator) -> Course:
    """Return the mean number of events so far at each time from 0 to `until_s`, with bootstrap percentile intervals.

    Args: events_s: of each mission, the times of its events, ascending.
    """
    time_s = np.linspace(0.0, until_s, _BAND_POINTS)
    counts = np.array([np.searchsorted(np.array(times_s), time_s, side="right") for times_s in events_s], dtype=float)
    mean = counts.mean(axis=0)
    if len(counts) < 2:
        unknown = np.full_like(mean, np.nan)
        return Course(time_s, mean, unknown, unknown)
    result = stats.bootstrap(
        (counts,), np.mean, n_resamples=_BAND_RESAMPLES, batch=BATCH // 10, method="percentile", rng=generator
    )
    return Course(time_s, mean, *result.confidence_interval)


def fisher_freeman_halton(samples: Sequence[np.ndarray], generator: np.random.Generator) -> float | None:
    """Return p of the hypothesis that samples of counts have one distribution, with random tables of the same margins.

    Returns: None if all counts are equal or there is only one sample, because then there is nothing to test.
    """
    values = np.unique(np.concatenate(list(samples)))
    if len(values) < 2 or len(samples) < 2:
        return None
    table = np.array([[np.count_nonzero(sample == value) for value in values] for sample in samples])
    if table.shape == (2, 2):
        return float(stats.fisher_exact(table).pvalue)
    # Not SciPy's fisher_exact, in which the probabilities of large tables underflow to 0, so that p becomes 1.
    tables = stats.random_table(table.sum(axis=1), table.sum(axis=0))
    seen = float(tables.logpmf(table)) + _TIE
    count = TABLES if table.size <= _LARGE_TABLE else TABLES // 10
    no_likelier = 0
    for start in range(0, count, BATCH):
        drawn = tables.rvs(size=min(BATCH, count - start), random_state=generator)
        no_likelier += int(np.count_nonzero(tables.logpmf(drawn) <= seen))
    return (1.0 + no_likelier) / (1.0 + count)


def survival(time_s: np.ndarray, finished: np.ndarray, until_s: float) -> Survival:
    """Return the Kaplan-Meier curve of missions still running, from 0 to `until_s`, as corners of its steps.

    The interval is Greenwood's on the log-log scale; where the share is 0 or 1, it has zero width.
    """
    curve = stats.ecdf(stats.CensoredData.right_censored(time_s, ~finished)).sf
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # Where the share is 0 or 1, the bounds are not numbers.
        bounds = curve.confidence_interval(method="log-log")
    times, share = curve.quantiles, curve.probabilities
    low, high = (
        np.where((share > 0.0) & (share < 1.0), bound.probabilities, share) for bound in (bounds.low, bounds.high)
    )
    end_s = max(until_s, float(times[-1]))
    return Survival(
        time_s=np.concatenate(([0.0], times, [end_s])),
        share=np.concatenate(([1.0], share, share[-1:])),
        low=np.concatenate(([1.0], low, low[-1:])),
        high=np.concatenate(([1.0], high, high[-1:])),
        censored_s=np.sort(time_s[~finished]),
    )
