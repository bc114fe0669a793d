"""Tests that two samples are equivalent."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

from robotteamsim.analysis.report.statistics import BATCH, RESAMPLES, Interval


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
            batch=BATCH,
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
