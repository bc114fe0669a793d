"""The velocity and position update of a robotic swarm [dissertation, eq. 22 and 25]."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

Vector = tuple[float, float]
"""(x, y) in one frame; positions [m], velocities [m per iteration]."""


@dataclass(frozen=True, slots=True)
class Weights:
    """c1..c4 of eq. (22): what a robot, its swarm, obstacles and the network have to say."""

    cognitive: float
    social: float
    obstacle: float
    communication: float


@dataclass(frozen=True, slots=True)
class Attractors:
    """x_LB, x_GB, x_OB and x_CB of eq. (22): where each of them draws the robot [m]."""

    local_best: Vector
    global_best: Vector
    obstacle: Vector
    communication: Vector


def next_velocity(
    position: Vector, inertia: Vector, attractors: Attractors, weights: Weights, rng: np.random.Generator
) -> Vector:
    """Return v[t+1] of eq. (22), or (25) where `inertia` is the fractional memory.

    v[t+1] = inertia + sum over the four components of c * r * (attractor - x[t]), with one random number r in [0, 1)
    per component. Four numbers are drawn whatever the weights, so that a weight never shifts the others' numbers.
    """
    v_x, v_y = inertia
    randoms = rng.random(4).tolist()
    for weight, random, (x, y) in (
        (weights.cognitive, randoms[0], attractors.local_best),
        (weights.social, randoms[1], attractors.global_best),
        (weights.obstacle, randoms[2], attractors.obstacle),
        (weights.communication, randoms[3], attractors.communication),
    ):
        v_x += weight * random * (x - position[0])
        v_y += weight * random * (y - position[1])
    return v_x, v_y


def limit_speed(velocity: Vector, max_speed: float) -> Vector:
    """Return the velocity, shortened to `max_speed` where it is longer; its direction stays."""
    speed = math.hypot(*velocity)
    if speed <= max_speed:
        return velocity
    return velocity[0] * max_speed / speed, velocity[1] * max_speed / speed


def next_position(position: Vector, velocity: Vector) -> Vector:
    """Return x[t+1] = x[t] + v[t+1]."""
    return position[0] + velocity[0], position[1] + velocity[1]
