"""The context of RDPSO's robots [dissertation, eq. 28 to 34], and the adaptation of their weights to it.

The adaptation follows the constraints 26 and 27 and the rules after 34 [5.2.2]. No source publishes membership
functions or levels. Ours: generalised bells of width 0.25 and slope 2 at 0 and 1, and the levels of `Levels`. Outputs
are levels weighted by the degrees of their rules; AND and OR are minimum and maximum.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from robotteamsim.swarm.velocity import Vector


def swarm_activity(velocities: ArrayLike, max_speed: float) -> float:
    """Return A_s of eq. (28): speed of the swarm's centre of mass over the maximum step; 0 at rest, 1 in full motion.

    Args:   velocities: shape (robots, dimensions) [same unit as max_speed].
    Raises: ValueError: no robots, or max_speed is not above 0.
    """
    v = np.asarray(velocities, dtype=np.float64)
    if len(v) == 0:
        raise ValueError("the activity of a swarm without robots is not defined")
    if not max_speed > 0.0:
        raise ValueError(f"max_speed must be > 0, got {max_speed}")
    return math.hypot(*np.mean(v, axis=0).tolist()) / max_speed


def robot_socialisation(position: Vector, global_best: Vector, positions: Iterable[Vector]) -> float:
    """Return S_n of eq. (29): 1 at the global best, 0 for the robot farthest from it.

    If all robots are at the global best, 0/0 counts as 1. Args: positions: of the whole swarm.
    """
    farthest_m = max(_distance_m(place, global_best) for place in positions)
    return 1.0 if farthest_m == 0.0 else 1.0 - _distance_m(position, global_best) / farthest_m


def _distance_m(place: Vector, other: Vector) -> float:
    d_x, d_y = place[0] - other[0], place[1] - other[1]
    return math.sqrt(d_x * d_x + d_y * d_y)


def robot_avoidance(clearance_m: float, sensing_radius_m: float) -> float:
    """Return O_n of eq. (30): 0 if nothing is within the sensing radius r_s, towards 1 at an obstacle.

    Raises: ValueError: the sensing radius is not above 0.
    """
    if not sensing_radius_m > 0.0:
        raise ValueError(f"sensing_radius_m must be > 0, got {sensing_radius_m}")
    return (sensing_radius_m - min(clearance_m, sensing_radius_m)) / sensing_radius_m


def robot_proximity_by_distance(distance_m: float, max_distance_m: float) -> float:
    """Return P_n of eq. (31) for the nearest neighbour: 1 at its position, 0 at d_max and beyond."""
    return max(0.0, 1.0 - distance_m / max_distance_m)


def robot_proximity_by_signal(signal_dbm: float, min_signal_dbm: float, signal_at_1_m_dbm: float) -> float:
    """Return P_n for the signal of the nearest neighbour: 1 at the signal at 1 m and above, 0 at q_min and below.

    Eq. (32) as printed is negative for signals in dBm; this is (q - q_min) / (q_1m - q_min) within [0, 1].

    Raises: ValueError: q_1m is not above q_min.
    """
    if not signal_at_1_m_dbm > min_signal_dbm:
        raise ValueError(f"the signal at 1 m, {signal_at_1_m_dbm} dBm, must be above the minimum, {min_signal_dbm} dBm")
    proximity = (signal_dbm - min_signal_dbm) / (signal_at_1_m_dbm - min_signal_dbm)
    return min(1.0, max(0.0, proximity))


def swarm_connectivity(fiedler_value: float, num_robots: int) -> float:
    """Return C_s of eq. (34): lambda_2 / N_s; 1 if all links exist, 0 if the swarm is split.

    A single robot is connected. Raises: ValueError: no robots.
    """
    if num_robots < 1:
        raise ValueError(f"the connectivity of a swarm of {num_robots} robots is not defined")
    if num_robots == 1:
        return 1.0
    return max(0.0, fiedler_value) / num_robots


BELL_WIDTH = 0.25
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


class Context(NamedTuple):
    """The metrics of one robot in its swarm.

    activity: A_s (28).  socialisation: S_n (29).  avoidance: O_n (30).  proximity: P_n (31, 32).
    connectivity: C_s (34).
    """

    activity: float
    socialisation: float
    avoidance: float
    proximity: float
    connectivity: float


class Coefficients(NamedTuple):
    """alpha and c1..c4 of one robot; c1 + c2 + c3 + c4 = 2."""

    alpha: float
    c1: float
    c2: float
    c3: float
    c4: float


def membership(value: float, centre: float) -> float:
    """Return the membership of a value in the set at `centre`: 1 there, 1/2 at a distance of 0.25, towards 0 beyond."""
    z = (value - centre) / BELL_WIDTH
    square = z * z
    return 1.0 / (1.0 + square * square)


def adapted_coefficients(kind: Literal["crisp", "fuzzy"], context: Context, levels: Levels) -> Coefficients:
    """Return alpha and c1..c4 by the rules of 5.2.2.

    `fuzzy` weights levels by membership; `crisp` rounds memberships of 1/2 and more to 1, others to 0. If two rules for
    alpha hold, the second refines the first. c3 and c4 are 0 if none of their rules holds.
    """
    degrees = [
        membership(context.activity, 1.0),
        membership(context.socialisation, 1.0),
        membership(context.avoidance, 1.0),
        membership(context.proximity, 0.0),
        membership(context.connectivity, 0.0),
    ]
    if kind == "crisp":
        degrees = [1.0 if degree >= 0.5 else 0.0 for degree in degrees]
    active, social, close, far, not_connected = degrees
    at_risk = max(far, not_connected)
    constrained = max(close, at_risk)
    alpha = _mix(active, levels.alpha_small, levels.alpha_large)
    alpha = _mix(constrained, levels.alpha_nominal, alpha)
    c3 = _mix(close, levels.c_large, _mix(at_risk, levels.c_small, 0.0))
    c4 = _mix(at_risk, levels.c_large, _mix(close, levels.c_small, 0.0))
    c_t = WEIGHT_SUM - c3 - c4
    c2 = _mix(max(social, constrained), levels.c2_share_small, levels.c2_share_large) * c_t
    return Coefficients(alpha, c_t - c2, c2, c3, c4)


def _mix(degree: float, holds: float, otherwise: float) -> float:
    """Return IF degree THEN holds ELSE otherwise, weighted by the degree."""
    return degree * holds + (1.0 - degree) * otherwise
