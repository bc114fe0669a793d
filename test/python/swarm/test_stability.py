"""Conditions of convergence, of the figure in docs/swarm.md."""

import runpy
from pathlib import Path

import numpy as np
import pytest

from robotteamsim.swarm import memory_coefficients

FIGURE = runpy.run_path(str(Path(__file__).parents[3] / "docs" / "draw_swarm.py"))
mean_radius, variance_radius = FIGURE["mean_radius"], FIGURE["variance_radius"]


@pytest.mark.parametrize("inertia", [0.0, 0.4, 0.7298, 0.95])
def test_mean_with_inertia_converges_up_to_the_known_bound(inertia):
    # (c1 + c2) / 2 < 2 (1 + w)
    bound = 2.0 * (1.0 + inertia)
    assert mean_radius((inertia,), bound - 0.01, bound - 0.01) < 1.0
    assert mean_radius((inertia,), bound + 0.01, bound + 0.01) > 1.0


@pytest.mark.parametrize("inertia", [0.0, 0.4, 0.7298, 0.95])
def test_variance_with_inertia_converges_up_to_the_known_bound(inertia):
    bound = 12.0 * (1.0 - inertia**2) / (7.0 - 5.0 * inertia)
    assert variance_radius((inertia,), 0.99 * bound, 0.99 * bound) < 1.0
    assert variance_radius((inertia,), 1.01 * bound, 1.01 * bound) > 1.0


def test_particle_without_memory_moves_by_the_weighted_attractors():
    assert mean_radius((0.0,), 0.5, 0.5) == pytest.approx(0.5)
    # E[(1 - c1 r1 - c2 r2)^2] = (1 - 1/2)^2 + (1/4 + 1/4) / 12
    assert variance_radius((0.0,), 0.5, 0.5) == pytest.approx(0.25 + 0.5 / 12.0)


def test_velocity_that_never_fades_never_rests():
    assert mean_radius((1.0,), 0.0, 0.0) == pytest.approx(1.0)
    assert variance_radius((1.0,), 1.0, 1.0) > 1.0


def test_memory_alone_keeps_a_particle_going_beyond_alpha_0632_published_and_never_exactly():
    assert mean_radius(memory_coefficients("published", 0.60, 4), 0.0, 0.0) == pytest.approx(1.0)
    assert mean_radius(memory_coefficients("published", 0.66, 4), 0.0, 0.0) > 1.01
    assert mean_radius(memory_coefficients("grunwald_letnikov", 0.99, 20), 0.0, 0.0) == pytest.approx(1.0)


def test_variance_of_many_simulated_particles_falls_at_the_computed_rate():
    memory, generator = memory_coefficients("grunwald_letnikov", 0.6, 4), np.random.default_rng(3)
    x = np.ones(200_000)
    moves = np.zeros((4, len(x)))
    variances = []
    for _ in range(14):
        pull = generator.random(len(x)) + generator.random(len(x))
        move = sum(c * v for c, v in zip(memory, moves, strict=True)) - pull * x
        x, moves = x + move, np.concatenate((move[None], moves[:-1]))
        variances.append(np.mean(x * x))
    rate = (variances[-1] / variances[5]) ** (1 / 8)
    assert rate == pytest.approx(variance_radius(memory, 1.0, 1.0), rel=0.1)
