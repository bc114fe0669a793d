"""What the swarm family finds on standard functions, beside pyswarms' PSO and SciPy's differential evolution.

Each has the same number of evaluations, points and bounds; bounds are not centred on the minimum, which swarms that
drift to the middle would else find for free. Printed and written: median of the best value found over the seeds, and a
95 % interval of that median by order statistics, which presumes no distribution.
Usage: python bench/swarm_bench.py [--functions sphere ackley] [--seeds 30] [--dimensions 10] [--evaluations 3000]
       [--csv bench/results/swarm.csv]
"""

from __future__ import annotations

import argparse
import csv
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy.optimize import differential_evolution
from scipy.stats import binom
from scipy.stats.qmc import LatinHypercube, scale

from robotteamsim.swarm import DpsoOptions, PsoOptions, RdpsoOptions, minimise
from robotteamsim.swarm.optimise import Method
from robotteamsim.swarm.options import Options

ROOT = Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT / "test" / "python" / "swarm"))

from objectives import ackley, griewank, rastrigin, rosenbrock, schaffer, sphere  # noqa: E402

Fun = Callable[[np.ndarray], np.ndarray]
Bounds = list[tuple[float, float]]

PARTICLES = 30
FUNCTIONS: dict[str, tuple[Fun, tuple[float, float]]] = {
    "sphere": (sphere, (-60.0, 40.0)),
    "rosenbrock": (rosenbrock, (-6.0, 4.0)),
    "rastrigin": (rastrigin, (-6.0, 4.0)),
    "griewank": (griewank, (-700.0, 500.0)),
    "ackley": (ackley, (-36.0, 24.0)),
    "schaffer": (schaffer, (-120.0, 80.0)),
}
FAMILY: dict[str, tuple[Method, Options]] = {
    "PSO (11)": ("pso", PsoOptions(inertia=1.0)),
    "PSO (14)": ("pso", PsoOptions()),
    "PSO, fractional": ("pso", PsoOptions(memory="grunwald_letnikov")),
    "DPSO (12, 13)": ("dpso", DpsoOptions()),
    "RDPSO (25)": ("rdpso", RdpsoOptions()),
    "RDPSO (25), published": ("rdpso", RdpsoOptions(memory="published")),
    "RDPSO, crisp": ("rdpso", RdpsoOptions(adaptation="crisp")),
    "RDPSO, fuzzy": ("rdpso", RdpsoOptions(adaptation="fuzzy")),
}
"""RPSO without obstacles takes the steps of PSO (14)."""
PEERS = ("pyswarms PSO", "SciPy DE")
OPTIMISERS = (*FAMILY, *PEERS)


def best_found(optimiser: str, fun: Fun, bounds: Bounds, evaluations: int, seed: int) -> float:
    """Return the least value that an optimiser finds with so many evaluations at most."""
    if optimiser == "pyswarms PSO":
        return pyswarms_best(fun, bounds, evaluations, seed)
    if optimiser == "SciPy DE":
        return de_best(fun, bounds, evaluations, seed)
    method, options = FAMILY[optimiser]
    found = minimise(
        fun, bounds, method=method, options=options, seed=seed, max_evaluations=evaluations, vectorized=True
    )
    assert found.nfev <= evaluations
    return float(found.fun)


def pyswarms_best(fun: Fun, bounds: Bounds, evaluations: int, seed: int) -> float:
    """Return what pyswarms' PSO finds with the coefficients of PSO (14), on bounds as it keeps them by default."""
    from pyswarms.single import GlobalBestPSO

    pso = PsoOptions()
    np.random.seed(seed)  # noqa: NPY002 - pyswarms draws from the global generator
    optimiser = GlobalBestPSO(
        n_particles=PARTICLES,
        dimensions=len(bounds),
        options={"c1": pso.c1, "c2": pso.c2, "w": pso.inertia},
        bounds=tuple(np.transpose(bounds)),
    )
    cost, _ = optimiser.optimize(fun, evaluations // PARTICLES, verbose=False)
    return float(cost)


def de_best(fun: Fun, bounds: Bounds, evaluations: int, seed: int) -> float:
    """Return what SciPy's differential evolution finds with as many points, without its final descent.

    It uses SciPy's defaults: it starts with a Latin hypercube and updates each point immediately, not per generation.
    """
    found = differential_evolution(
        lambda x: float(fun(x[np.newaxis])[0]),
        bounds,
        init=scale(LatinHypercube(len(bounds), rng=seed).random(PARTICLES), *np.transpose(bounds)),
        maxiter=evaluations // PARTICLES - 1,
        tol=0.0,
        atol=0.0,
        polish=False,
        rng=seed,
        updating="immediate",
    )
    assert found.nfev <= evaluations
    return float(found.fun)


def median_interval(values: np.ndarray) -> tuple[float, float, float]:
    """Return the median and the least and greatest value of its 95 % interval, by order statistics."""
    ordered, n = np.sort(values), len(values)
    # With k values cut off at each end, the median is outside with chance 2 P(Binomial(n, 1/2) <= k).
    cut = max((k for k in range((n + 1) // 2) if 2.0 * binom.cdf(k, n, 0.5) <= 0.05), default=0)
    return float(np.median(ordered)), float(ordered[cut]), float(ordered[n - 1 - cut])


def measure(
    functions: list[str], optimisers: list[str], seeds: int, dimensions: int, evaluations: int
) -> list[dict[str, object]]:
    """Return a row for each function and optimiser."""
    rows: list[dict[str, object]] = []
    for name in functions:
        fun, span = FUNCTIONS[name]
        for optimiser in optimisers:
            bounds = [span] * dimensions
            values = np.array([best_found(optimiser, fun, bounds, evaluations, seed) for seed in range(seeds)])
            median, low, high = median_interval(values)
            rows.append(
                {
                    "function": name,
                    "optimiser": optimiser,
                    "dimensions": dimensions,
                    "evaluations": evaluations,
                    "seeds": seeds,
                    "median": f"{median:.3g}",
                    "low_95": f"{low:.3g}",
                    "high_95": f"{high:.3g}",
                }
            )
            print(f"{name:12}{optimiser:26}{median:10.2g}   {low:.2g} .. {high:.2g}", flush=True)
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--functions", nargs="+", choices=FUNCTIONS, default=list(FUNCTIONS), metavar="NAME")
    parser.add_argument("--optimisers", nargs="+", choices=OPTIMISERS, default=list(OPTIMISERS), metavar="NAME")
    parser.add_argument("--seeds", type=int, default=30)
    parser.add_argument("--dimensions", type=int, default=10)
    parser.add_argument("--evaluations", type=int, default=3_000)
    parser.add_argument("--csv", type=Path, default=ROOT / "bench" / "results" / "swarm.csv")
    arguments = parser.parse_args()
    rows = measure(
        arguments.functions, arguments.optimisers, arguments.seeds, arguments.dimensions, arguments.evaluations
    )
    arguments.csv.parent.mkdir(parents=True, exist_ok=True)
    with arguments.csv.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)


if __name__ == "__main__":
    main()
