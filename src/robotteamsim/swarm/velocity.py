"""The velocity and position update of a robotic swarm [dissertation, eq. 22 and 25]."""

import math
from collections.abc import Iterator
from itertools import islice
from typing import NamedTuple

import numpy as np

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


def uniform_numbers(rng: np.random.Generator) -> Iterator[float]:
    """Return an endless sequence of a generator's numbers in [0, 1).

    They are drawn in blocks, which is faster, so nothing else may draw from the generator.
    """
    while True:
        yield from rng.random(64).tolist()


def next_velocity(
    position: Vector,
    inertia: Vector,
    attractors: tuple[Vector, Vector, Vector, Vector],
    weights: tuple[float, float, float, float],
    numbers: Iterator[float],
) -> Vector:
    """Return v[t+1] of eq. (22), or (25) if `inertia` is the fractional memory.

    v[t+1] = inertia + sum over the four components of c * r * (attractor - x[t]), with one random number r in [0, 1)
    per component. Four numbers are always used, so that a weight of 0 does not shift the numbers of other components.

    Args:   attractors: `Attractors`, or a tuple in their order.  weights: `Weights`, likewise.
    Raises: ValueError: fewer than four numbers are left.
    """
    drawn = tuple(islice(numbers, 4))
    if len(drawn) < len(attractors):
        raise ValueError("there must be a random number for each attractor")
    return _core.swarm.next_velocity(position, inertia, attractors, weights, drawn)


def limit_speed(velocity: Vector, max_speed: float) -> Vector:
    """Return the velocity limited to `max_speed`, in the same direction."""
    speed = math.hypot(*velocity)
    if speed <= max_speed:
        return velocity
    return velocity[0] * max_speed / speed, velocity[1] * max_speed / speed


def next_position(position: Vector, velocity: Vector) -> Vector:
    """Return x[t+1] = x[t] + v[t+1]."""
    return position[0] + velocity[0], position[1] + velocity[1]
