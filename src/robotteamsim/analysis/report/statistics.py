"""Confidence intervals, tests of equivalence and of counts, computed by SciPy and statsmodels."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats
from statsmodels.duration.survfunc import SurvfuncRight
from statsmodels.stats.proportion import proportion_confint

RESAMPLES = 9_999
"""Number of resamples of a bootstrap."""

TABLES = 99_999
"""Number of random tables of a Fisher-Freeman-Halton test; a tenth of it for large tables."""

_BATCH = 1_000
_LARGE_TABLE = 60
_TIE = 1e-9


@dataclass(frozen=True, slots=True)
class Interval:
    """An estimate with its confidence bounds."""

    value: float
    low: float
    high: float

    def __contains__(self, value: float) -> bool:
        return self.low <= value <= self.high


@dataclass(frozen=True, slots=True)
class Equivalence:
    """A statistic that compares samples, and whether it is between two limits.

    interval: 90 % bootstrap interval.
    p:        p of the two one-sided tests for a value between the limits.
    """

    interval: Interval
    limits: tuple[float, float]
    p: float

    @property
    def outside(self) -> bool:
        """Whether the whole interval is outside the limits."""
        return self.interval.high < self.limits[0] or self.interval.low > self.limits[1]


@dataclass(frozen=True, slots=True, eq=False)
class Survival:
    """Share of missions still running at each time, with a pointwise 95 % interval; arrays of equal shape."""

    time_s: np.ndarray
    share: np.ndarray
    low: np.ndarray
    high: np.ndarray
    censored_s: np.ndarray


def clopper_pearson(successes: int, count: int, confidence: float = 0.95) -> Interval:
    """Return a share with its exact interval. Raises: ValueError: count is below 1."""
    if count < 1:
        raise ValueError("count must be at least 1")
    low, high = proportion_confint(successes, count, alpha=1.0 - confidence, method="beta")
    # At 0 and 1, statsmodels returns NaN or a value outside by a rounding error.
    low = 0.0 if successes == 0 else float(low)
    high = 1.0 if successes == count else float(high)
    return Interval(successes / count, low, high)


def bootstrap_mean(values: np.ndarray, generator: np.random.Generator, confidence: float = 0.95) -> Interval:
    """Return the mean with its percentile bootstrap interval; the interval of equal or single values has zero width."""
    mean = float(np.mean(values))
    if len(values) < 2 or np.ptp(values) == 0:
        return Interval(mean, mean, mean)
    result = stats.bootstrap(
        (values,),
        np.mean,
        n_resamples=RESAMPLES,
        batch=_BATCH,
        confidence_level=confidence,
        method="percentile",
        rng=generator,
    )
    low, high = result.confidence_interval
    return Interval(mean, float(low), float(high))


def equivalence(
    samples: Sequence[np.ndarray],
    statistic: Callable[..., np.ndarray],
    limits: tuple[float, float],
    generator: np.random.Generator,
) -> Equivalence:
    """Return a statistic of several samples, with two one-sided tests that it is between two limits.

    All samples are resampled. p is the larger share of resampled values beyond either limit; if it is below 0.05, the
    90 % interval is within the limits. With a sample of one value, the interval is unbounded.

    Args:   statistic: of the samples, each with `axis` as its axis of values.
    Raises: ValueError: a sample is empty.
    """
    if not all(map(len, samples)):
        raise ValueError("samples must not be empty")
    value = float(statistic(*samples, axis=-1)) if min(map(len, samples)) > 1 else math.nan
    if math.isnan(value):
        return Equivalence(Interval(value, -math.inf, math.inf), limits, 1.0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", stats.DegenerateDataWarning)
        result = stats.bootstrap(
            tuple(samples),
            statistic,
            n_resamples=RESAMPLES,
            batch=_BATCH,
            confidence_level=0.9,
            method="percentile",
            vectorized=True,
            rng=generator,
        )
    values = result.bootstrap_distribution
    beyond = max(np.count_nonzero(values <= limits[0]), np.count_nonzero(values >= limits[1]))
    low, high = result.confidence_interval
    return Equivalence(Interval(value, float(low), float(high)), limits, (1.0 + float(beyond)) / (RESAMPLES + 1.0))


def mean_ratio(a: np.ndarray, b: np.ndarray, axis: int) -> np.ndarray:
    """Return the ratio of means."""
    return np.asarray(np.mean(a, axis=axis) / np.mean(b, axis=axis))


def median_ratio(a: np.ndarray, b: np.ndarray, axis: int) -> np.ndarray:
    """Return the ratio of medians."""
    return np.asarray(np.median(a, axis=axis) / np.median(b, axis=axis))


def sd_ratio(a: np.ndarray, b: np.ndarray, axis: int) -> np.ndarray:
    """Return the ratio of sample standard deviations."""
    return np.asarray(np.std(a, axis=axis, ddof=1) / np.std(b, axis=axis, ddof=1))


def mean_difference(a: np.ndarray, b: np.ndarray, axis: int) -> np.ndarray:
    """Return the difference of means, a - b."""
    return np.asarray(np.mean(a, axis=axis) - np.mean(b, axis=axis))


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
    for start in range(0, count, _BATCH):
        drawn = tables.rvs(size=min(_BATCH, count - start), random_state=generator)
        no_likelier += int(np.count_nonzero(tables.logpmf(drawn) <= seen))
    return (1.0 + no_likelier) / (1.0 + count)


def survival(time_s: np.ndarray, finished: np.ndarray, until_s: float) -> Survival:
    """Return the Kaplan-Meier curve of missions still running, from 0 to `until_s`, as corners of its steps.

    The interval is Greenwood's on the log-log scale; where the share is 0 or 1, it has zero width.
    """
    curve = SurvfuncRight(time_s, finished.astype(int)) if finished.any() else None
    times = np.asarray(curve.surv_times if curve else [])
    share = np.asarray(curve.surv_prob if curve else [])
    error = np.asarray(curve.surv_prob_se if curve else [])
    inner = (share > 0.0) & (share < 1.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        half = stats.norm.ppf(0.975) * error / np.abs(share * np.log(share))
        low = np.where(inner, share ** np.exp(half), share)
        high = np.where(inner, share ** np.exp(-half), share)
    return Survival(
        time_s=np.concatenate(([0.0], times, [max(until_s, *times, 0.0) if len(times) else until_s])),
        share=np.concatenate(([1.0], share, share[-1:] if len(share) else [1.0])),
        low=np.concatenate(([1.0], low, low[-1:] if len(low) else [1.0])),
        high=np.concatenate(([1.0], high, high[-1:] if len(high) else [1.0])),
        censored_s=np.sort(time_s[~finished]),
    )
