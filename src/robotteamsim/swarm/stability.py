"""Conditions on memory and coefficients under which a particle with constant bests comes to rest."""

from collections.abc import Sequence

import numpy as np


def mean_radius(memory: Sequence[float], c1: float, c2: float) -> float:
    """Return the asymptotic factor per iteration of the distance between a particle's expected position and its best.

    Below 1 the mean converges. With both bests at 0 and r1, r2 uniform in [0, 1], (25) is linear in x[t+1], x[t], ...;
    this is the spectral radius of its expectation.

    Args: memory: weights of v[t], v[t-1], ..., as of `memory_coefficients`, or (w,) for an inertia.
    """
    return _radius(_mean_matrix(memory, (c1 + c2) / 2.0))


def variance_radius(memory: Sequence[float], c1: float, c2: float) -> float:
    """Return the asymptotic factor per iteration of the variance of a particle's position.

    Below 1 the particle comes to rest; if it is above 1 but `mean_radius` is below, the particle oscillates around its
    bests with a growing amplitude. It is the spectral radius of the expected Kronecker square of (25); see
    `mean_radius`. For an inertia it is below 1 if c1 + c2 < 24 (1 - w^2) / (7 - 5 w), with c1 = c2 [poli2009].
    """
    mean = _mean_matrix(memory, (c1 + c2) / 2.0)
    pull = np.zeros_like(mean)
    pull[0, 0] = 1.0
    variance = (c1 * c1 + c2 * c2) / 12.0
    return _radius(np.kron(mean, mean) + variance * np.kron(pull, pull))


def _mean_matrix(memory: Sequence[float], pull: float) -> np.ndarray:
    """Return the companion matrix that takes (x[t], x[t-1], ...) to (x[t+1], x[t], ...), with v[t] = x[t] - x[t-1]."""
    terms = len(memory)
    matrix = np.eye(terms + 1, k=-1)
    matrix[0, 0] = 1.0 - pull
    for k, coefficient in enumerate(memory):
        matrix[0, k] += coefficient
        matrix[0, k + 1] -= coefficient
    return matrix


def _radius(matrix: np.ndarray) -> float:
    return float(np.max(np.abs(np.linalg.eigvals(matrix))))
