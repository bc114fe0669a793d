"""Fractional memory of past velocities [dissertation, eq. 23 and 24]."""

from collections.abc import Iterable
from typing import Literal

from robotteamsim import _core
from robotteamsim.swarm.velocity import Vector

MemoryMode = Literal["published", "grunwald_letnikov"]

PUBLISHED_TERMS = 4
"""Number of terms of eq. (24)."""


def memory_coefficients(mode: MemoryMode, alpha: float, terms: int) -> tuple[float, ...]:
    """Return the weights of v[t], v[t-1], ... in the memory term.

    `published` is eq. (24) as printed: a, a/2, a(1-a)/6, a(1-a)(2-a)/24; each term lacks its last factor.
    `grunwald_letnikov` is the intended series of eq. (23): a, a(1-a)/2, a(1-a)(2-a)/6, a(1-a)(2-a)(3-a)/24, ...: the
    k-th coefficient is (-1)^(k+1) binomial(a, k).

    Args:   alpha: fractional order in [0, 1].  terms: truncation order r, at least 1.
    Raises: ValueError: out of these ranges, or more terms of `published` than there are.
    """
    if not 0.0 <= alpha <= 1.0:
        raise ValueError(f"alpha must lie in [0, 1], got {alpha}")
    if terms < 1:
        raise ValueError(f"the memory needs at least 1 term, got {terms}")
    if mode == "published":
        if terms > PUBLISHED_TERMS:
            raise ValueError(f"the published memory has {PUBLISHED_TERMS} terms, got {terms}")
        a = alpha
        return (a, a / 2.0, a * (1.0 - a) / 6.0, a * (1.0 - a) * (2.0 - a) / 24.0)[:terms]
    coefficients = [alpha]
    for k in range(1, terms):
        coefficients.append(coefficients[-1] * (k - alpha) / (k + 1))
    return tuple(coefficients)


def memory_term(coefficients: tuple[float, ...], velocities: Iterable[Vector]) -> Vector:
    """Return the weighted sum of past velocities, newest first; missing ones count as zero [same unit]."""
    return _core.swarm.memory_term(coefficients, tuple(velocities))
