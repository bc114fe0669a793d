"""The interval of all means that the studies state."""

from __future__ import annotations

import numpy as np
from scipy.stats import bootstrap


def mean_with_interval(values: np.ndarray) -> tuple[float, float, float]:
    """Return a mean and its 95 % bootstrap interval; of equal values, or a single one, the mean three times."""
    mean = float(values.mean())
    if np.ptp(values) == 0.0:
        return mean, mean, mean
    interval = bootstrap((values,), np.mean, method="percentile", rng=np.random.default_rng(1)).confidence_interval
    return mean, float(interval.low), float(interval.high)
