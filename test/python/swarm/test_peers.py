"""The comparison of bench/swarm_bench.py, with few seeds."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from objectives import ackley, rastrigin, sphere

PATH = Path(__file__).resolve().parents[3] / "bench" / "swarm_bench.py"
SPEC = importlib.util.spec_from_file_location("swarm_bench", PATH)
assert SPEC
assert SPEC.loader
bench = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(bench)


def median(optimiser, fun):
    return np.median([bench.best_found(optimiser, fun, [(-6.0, 4.0)] * 4, 1500, seed) for seed in range(5)])


@pytest.mark.parametrize("fun", [sphere, ackley, rastrigin])
def test_pso_of_eq_14_finds_what_pyswarms_finds_with_the_same_coefficients(fun):
    assert median("PSO (14)", fun) <= 10.0 * median("pyswarms PSO", fun) + 1.0


@pytest.mark.parametrize("optimiser", ["PSO, fractional", "RDPSO (25)", "SciPy DE"])
def test_damped_swarms_and_differential_evolution_leave_the_undamped_pso_behind(optimiser):
    assert median(optimiser, ackley) < 0.3 * median("PSO (11)", ackley)


def test_differential_evolution_updates_each_point_at_once():
    # With updates per generation the median is about 4e-4.
    found = [bench.best_found("SciPy DE", sphere, [(-60.0, 40.0)] * 10, 3000, seed) for seed in range(9)]
    assert np.median(found) < 1e-4


def test_interval_of_the_median_cuts_nine_of_thirty_values_at_each_end():
    # P(Binomial(30, 1/2) <= 9) = 0.021, <= 10: 0.049
    assert bench.median_interval(np.arange(30.0)) == (14.5, 9.0, 20.0)
    assert bench.median_interval(np.array([3.0, 1.0])) == (2.0, 1.0, 3.0)
