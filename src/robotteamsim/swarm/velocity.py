"""The velocity and position update of a robotic swarm [dissertation, eq. 22 and 25]."""

import math
from collections.abc import Iterable, Iterator
from itertools import islice
from typing import NamedTuple, TypeVar, cast

import numpy as np

from robotteamsim import _core

Coordinates = TypeVar("Coordinates", float, np.ndarray)
"""One coordinate of one robot, or an array of those of many."""

Vector = tuple[float, float]
"""(x, y) in one frame; positions [m], velocities [m per iteration]."""


class Weights(NamedTuple):
    """c1..c4 of eq. (22): what a robot, its swarm, obstacles and the network have to say."""

    cognitive: float
    social: float
    obstacle: float
    communication: float


class Attractors(NamedTuple):
    """x_LB, x_GB, x_OB and x_CB of eq. (22): where each of them draws the robot [m]."""

    local_best: Vector
    global_best: Vector
    obstacle: Vector
    communication: Vector


def uniform_numbers(rng: np.random.Generator) -> Iterator[float]:
    """Return the numbers in [0, 1) that a generator draws, one after the other, without end.

    They are drawn many at once, in a fraction of the time, so nobody else may draw from the generator.
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
    """Return v[t+1] of eq. (22), or (25) where `inertia` is the fractional memory.

    v[t+1] = inertia + sum over the four components of c * r * (attractor - x[t]), with one random number r in [0, 1)
    per component. Four of the numbers, uniform in [0, 1), are taken whatever the weights, so that a weight never shifts
    the others' numbers.

    Args:   attractors: `Attractors`, or a tuple in their order.  weights: `Weights`, likewise.
    Raises: ValueError: fewer than four numbers are left.
    """
    drawn = tuple(islice(numbers, 4))
    if len(drawn) < len(attractors):
        raise ValueError("there must be a random number for each attractor")
    return _core.swarm.next_velocity(position, inertia, attractors, weights, drawn)


def add_pulls(
    inertia: Coordinates,
    position: Coordinates,
    pulls: Iterable[tuple[float | np.ndarray, float | np.ndarray, Coordinates]],
) -> Coordinates:
    """Return inertia + the sum of c * r * (attractor - position) over (c, r, attractor), in the order given.

    For all of a swarm at once: arrays of one shape.
    """
    velocity: float | np.ndarray = inertia
    for weight, random, attractor in pulls:
        velocity = velocity + weight * random * (attractor - position)
    return cast(Coordinates, velocity)


def limit_speed(velocity: Vector, max_speed: float) -> Vector:
    """Return the velocity, shortened to `max_speed` where it is longer; its direction stays."""
    speed = math.hypot(*velocity)
    if speed <= max_speed:
        return velocity
    return velocity[0] * max_speed / speed, velocity[1] * max_speed / speed


def next_position(position: Vector, velocity: Vector) -> Vector:
    """Return x[t+1] = x[t] + v[t+1]."""
    return position[0] + velocity[0], position[1] + velocity[1]
