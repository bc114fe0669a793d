"""The velocity and position update of a robotic swarm [dissertation, eq. 22 to 25], with its memory and attractors."""

import math
from collections.abc import Iterable, Sequence
from typing import Literal, NamedTuple

from robotteamsim import _core

Vector = tuple[float, float]
"""(x, y) in one frame; positions [m], velocities [m per iteration]."""


class Weights(NamedTuple):
    """c1..c4 of eq. (22): weights of local best, global best, obstacles and network."""

    cognitive: float
    social: float
    obstacle: float
    communication: float


class Attractors(NamedTuple):
    """x_LB, x_GB, x_OB and x_CB of eq. (22) [m]."""

    local_best: Vector
    global_best: Vector
    obstacle: Vector
    communication: Vector


def next_velocity(
    position: Vector,
    inertia: Vector,
    attractors: tuple[Vector, Vector, Vector, Vector],
    weights: tuple[float, float, float, float],
    numbers: Sequence[float],
) -> Vector:
    """Return v[t+1] of eq. (22), or (25) if `inertia` is the fractional memory.

    v[t+1] = inertia + sum over the four components of c * r * (attractor - x[t]).

    Args: attractors: `Attractors`, or a tuple in their order.  weights: `Weights`, likewise.
          numbers: r of each component, random in [0, 1); one also for a component whose weight is 0.
    """
    return _core.swarm.next_velocity(position, inertia, attractors, weights, numbers)


def limit_speed(velocity: Vector, max_speed: float) -> Vector:
    """Return the velocity limited to `max_speed`, in the same direction."""
    speed = math.hypot(*velocity)
    if speed <= max_speed:
        return velocity
    return velocity[0] * max_speed / speed, velocity[1] * max_speed / speed


def next_position(position: Vector, velocity: Vector) -> Vector:
    """Return x[t+1] = x[t] + v[t+1]."""
    return position[0] + velocity[0], position[1] + velocity[1]


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


def communication_attractor(position: Vector, neighbour: Vector, range_m: float) -> Vector:
    """Return x_CB: the point at `range_m` from the neighbour, in the direction of the robot [5.2.2].

    It attracts a robot that is farther away back to that distance, and pushes a nearer one out to it. A robot at the
    position of its neighbour stays there.
    """
    away_x, away_y = position[0] - neighbour[0], position[1] - neighbour[1]
    distance_m = math.hypot(away_x, away_y)
    if distance_m == 0.0:
        return position
    return neighbour[0] + away_x / distance_m * range_m, neighbour[1] + away_y / distance_m * range_m


def communication_weight(c4: float, proximity: float, endangered_proximity: float, connected: bool) -> float:
    """Return the weight of the communication term: 0 while the link is safe, c4 if it is lost.

    In between it grows as the proximity P_n falls from that of an endangered link to 0. x_CB pushes robots apart
    wherever a link is good; without this weight, missions fail.

    Args: proximity: P_n of eq. (31) or (32).  endangered_proximity: P_n at the threshold, in (0, 1].
          connected: whether the swarm connectivity C_s of eq. (34) is above 0.
    """
    if not connected:
        return c4
    return c4 * max(0.0, 1.0 - proximity / endangered_proximity)
