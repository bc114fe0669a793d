"""Tests and effect sizes of two or more samples; the tests are exact for small samples."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy import stats
from statsmodels.stats.multitest import multipletests
from statsmodels.stats.weightstats import CompareMeans, DescrStatsW

from robotteamsim.analysis.report.statistics import Interval

PERMUTATIONS = 20_000
"""If samples can be permuted in no more ways than this, a test tries them all and is exact, also with ties."""

SMALL = 50
"""Up to this many values in all, a Kruskal-Wallis test permutes them instead of assuming a chi-squared distribution."""


def mann_whitney(a: np.ndarray, b: np.ndarray, alternative: str = "two-sided") -> float | None:
    """Return p of the hypothesis that two samples have one distribution, or None if there are too few values.

    Args: alternative: "two-sided", or "greater" for the alternative that a is larger.
    """
    if min(len(a), len(b)) < 2:
        return None
    few = math.comb(len(a) + len(b), len(a)) <= PERMUTATIONS
    method = stats.PermutationMethod(n_resamples=PERMUTATIONS) if few else "auto"
    return float(stats.mannwhitneyu(a, b, alternative=alternative, method=method).pvalue)


def wilcoxon(a: np.ndarray, b: np.ndarray) -> float | None:
    """Return p of the hypothesis that differences of pairs are symmetric about 0; None if there is nothing to test."""
    differences = np.asarray(a, dtype=float) - b
    if len(differences) < 2 or not differences.any():
        return None
    few = 2 ** len(differences) <= PERMUTATIONS
    method = stats.PermutationMethod(n_resamples=PERMUTATIONS) if few else "auto"
    return float(stats.wilcoxon(differences, method=method).pvalue)


def kruskal_wallis(samples: Sequence[np.ndarray], generator: np.random.Generator) -> float | None:
    """Return p of the hypothesis that all samples have one distribution, or None if there is nothing to test."""
    if len(samples) < 2 or np.ptp(np.concatenate(list(samples))) == 0 or min(map(len, samples)) < 2:
        return None
    if sum(map(len, samples)) > SMALL:
        return float(stats.kruskal(*samples).pvalue)
    result = stats.permutation_test(
        tuple(samples),
        lambda *permuted, axis: stats.kruskal(*permuted, axis=axis).statistic,
        permutation_type="independent",
        alternative="greater",
        vectorized=True,
        n_resamples=PERMUTATIONS,
        batch=1_000,
        rng=generator,
    )
    return float(result.pvalue)


def holm(p_values: Sequence[float | None]) -> list[float | None]:
    """Return p values with Holm's correction; None stays None."""
    known = [p for p in p_values if p is not None]
    if len(known) < 2:
        return list(p_values)
    corrected = iter(multipletests(known, method="holm")[1].tolist())
    return [None if p is None else next(corrected) for p in p_values]


def mean_shift(a: np.ndarray, b: np.ndarray, paired: bool) -> Interval:
    """Return mean(b) - mean(a) with its 95 % t interval (Welch's, or that of the differences of pairs).

    The bounds are NaN where the samples have too few values or no spread to estimate them.
    """
    value = float(np.mean(b) - np.mean(a))
    spreads = [np.asarray(b, dtype=float) - a] if paired else [a, b]
    if min(map(len, spreads)) < 2 or not any(np.ptp(values) for values in spreads):
        return Interval(value, math.nan, math.nan)
    described = [DescrStatsW(values) for values in spreads]
    if paired:
        low, high = described[0].tconfint_mean()
    else:
        low, high = CompareMeans(described[1], described[0]).tconfint_diff(usevar="unequal")
    return Interval(value, float(low), float(high))


def superiority(a: np.ndarray, b: np.ndarray, paired: bool) -> float:
    """Return the probability that a value of b is larger than one of a, or than that of its pair; ties count half."""
    signs = np.sign(np.asarray(b, dtype=float) - a) if paired else np.sign(np.subtract.outer(b, a).astype(float))
    return float(0.5 + 0.5 * np.mean(signs))
