"""Adaptation of RDPSO's weights to the context [dissertation, 5.2.2: constraints 26 and 27, and the rules after 34].

No source publishes membership functions or levels. Ours: generalised bells of width 0.25 and slope 2 at 0 and 1, and
the levels of `Levels`. Outputs are levels weighted by the degrees of their rules; AND and OR are minimum and maximum.
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

Adaptation = Literal["none", "crisp", "fuzzy"]

BELL_WIDTH = 0.25
BELL_SLOPE = 2
WEIGHT_SUM = 2.0
"""c1 + c2 + c3 + c4 of eq. (26)."""


@dataclass(frozen=True, slots=True)
class Levels:
    """The values of small, nominal and large; c2 is a fraction of c_T = c1 + c2 = 2 - c3 - c4.

    Raises: ValueError: levels not ascending or outside [0, 1], which ensures c_T >= 0 in (26).
    """

    alpha_small: float = 0.3
    alpha_nominal: float = 0.6
    alpha_large: float = 0.9
    c2_share_small: float = 0.3
    c2_share_large: float = 0.8
    c_small: float = 0.2
    """of c3 and c4"""
    c_large: float = 0.8

    def __post_init__(self) -> None:
        for name, levels in (
            ("alpha", (self.alpha_small, self.alpha_nominal, self.alpha_large)),
            ("c2_share", (self.c2_share_small, self.c2_share_large)),
            ("c", (self.c_small, self.c_large)),
        ):
            if not all(lower <= higher for lower, higher in pairwise((0.0, *levels, 1.0))):
                raise ValueError(f"the levels of {name} must rise within [0, 1], got {levels}")


EXACT_LEVELS = Levels()
"""Levels for the memory `grunwald_letnikov`, which is stable up to alpha = 1."""

PUBLISHED_LEVELS = Levels(alpha_small=0.2, alpha_nominal=0.45, alpha_large=0.6)
"""Levels for the memory `published`, whose coefficients sum to 1 already at alpha = 0.632."""


@dataclass(frozen=True, slots=True)
class Context:
    """The metrics of one swarm's robots; arrays have shape (robots,).

    activity: A_s (28).  socialisation: S_n (29).  avoidance: O_n (30).  proximity: P_n (31, 32).
    connectivity: C_s (34).
    """

    activity: float
    socialisation: np.ndarray
    avoidance: np.ndarray
    proximity: np.ndarray
    connectivity: float


@dataclass(frozen=True, slots=True)
class Coefficients:
    """alpha and c1..c4 of every robot; float64, shape (robots,). c1 + c2 + c3 + c4 = 2."""

    alpha: np.ndarray
    c1: np.ndarray
    c2: np.ndarray
    c3: np.ndarray
    c4: np.ndarray


def membership(value: float | np.ndarray, centre: float) -> np.ndarray:
    """Return the membership of a value in the set at `centre`: 1 there, 1/2 at a distance of 0.25, towards 0 beyond."""
    z = (np.asarray(value, dtype=np.float64) - centre) / BELL_WIDTH
    power = z * z
    for _ in range(BELL_SLOPE - 1):
        power = power * (z * z)
    return np.asarray(1.0 / (1.0 + power))


def adapted_coefficients(kind: Literal["crisp", "fuzzy"], context: Context, levels: Levels) -> Coefficients:
    """Return alpha and c1..c4 by the rules of 5.2.2.

    `fuzzy` weights levels by membership; `crisp` rounds memberships of 1/2 and more to 1, others to 0. If two rules for
    alpha hold, the second refines the first. c3 and c4 are 0 if none of their rules holds.
    """
    active = membership(context.activity, 1.0)
    social = membership(context.socialisation, 1.0)
    close = membership(context.avoidance, 1.0)
    far = membership(context.proximity, 0.0)
    not_connected = membership(context.connectivity, 0.0)
    if kind == "crisp":
        active, social, close, far, not_connected = (
            np.where(degree >= 0.5, 1.0, 0.0) for degree in (active, social, close, far, not_connected)
        )
    at_risk = np.maximum(far, not_connected)
    constrained = np.maximum(close, at_risk)
    alpha = _mix(active, levels.alpha_small, levels.alpha_large)
    alpha = _mix(constrained, levels.alpha_nominal, alpha)
    c3 = _mix(close, levels.c_large, _mix(at_risk, levels.c_small, 0.0))
    c4 = _mix(at_risk, levels.c_large, _mix(close, levels.c_small, 0.0))
    c_t = WEIGHT_SUM - c3 - c4
    c2 = _mix(np.maximum(social, constrained), levels.c2_share_small, levels.c2_share_large) * c_t
    return Coefficients(alpha, c_t - c2, c2, c3, c4)


def _mix(degree: np.ndarray, holds: float | np.ndarray, otherwise: float | np.ndarray) -> np.ndarray:
    """Return IF degree THEN holds ELSE otherwise, weighted by the degree."""
    return degree * holds + (1.0 - degree) * otherwise
