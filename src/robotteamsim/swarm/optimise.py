"""The particle swarm family as optimisers of any objective: PSO, DPSO, RPSO and RDPSO."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from robotteamsim.rng import stream
from robotteamsim.swarm.objective import Objective, UndefinedValue
from robotteamsim.swarm.options import (
    DpsoOptions,
    Options,
    PsoOptions,
    RdpsoOptions,
    RpsoOptions,
    SwarmSizes,
    check_whole,
)
from robotteamsim.swarm.population import OUTSIDE, Population, move, start
from robotteamsim.swarm.selection import select_particles, select_robots

if TYPE_CHECKING:
    from scipy.optimize import OptimizeResult

Method = Literal["pso", "dpso", "rpso", "rdpso"]
OPTIONS: dict[str, type[Options]] = {"pso": PsoOptions, "dpso": DpsoOptions, "rpso": RpsoOptions, "rdpso": RdpsoOptions}

Callback = Callable[["OptimizeResult"], Any]


def minimise(
    fun: Callable[[np.ndarray], Any],
    bounds: Sequence[tuple[float, float]] | ArrayLike,
    *,
    method: Method = "rdpso",
    seed: int | np.random.Generator = 0,
    max_evaluations: int = 10_000,
    options: Options | None = None,
    vectorized: bool = False,
    callback: Callback | None = None,
) -> OptimizeResult:
    """Minimise an objective within bounds with a particle swarm.

    The same seed gives a bit-identical result.

    Args:   fun: the objective of a point, shape (dimensions,); with `vectorized`, of many points at once, shape
                (particles, dimensions), with one value each. Infinities are values like any other.
            bounds: (low, high) for each dimension.
            seed: of the random stream, or a generator.
            max_evaluations: an iteration that would need more is not started.
            options: of the method's own class; by default its default options.
            callback: called after each iteration with the result so far, which then also has `positions`, shape
                (particles, dimensions), and `swarm_ids`, shape (particles,), -1 for excluded robots. A true return
                value, or StopIteration, ends the run.
    Returns: a scipy.optimize.OptimizeResult: x, fun, nfev, nit, success, message; history, shape (nit + 1,): the best
            value after each iteration; history_nfev, int, shape (nit + 1,): the evaluations up to then. success is
            False if the objective returned NaN or the callback ended the run.
    Raises: ValueError: invalid bounds, options or number of evaluations; an objective that raises, or returns another
            shape. The message names the particle.
    """
    return _run(Objective(fun, vectorized, sign=-1.0), bounds, method, seed, max_evaluations, options, callback)


def maximise(
    fun: Callable[[np.ndarray], Any],
    bounds: Sequence[tuple[float, float]] | ArrayLike,
    *,
    method: Method = "rdpso",
    seed: int | np.random.Generator = 0,
    max_evaluations: int = 10_000,
    options: Options | None = None,
    vectorized: bool = False,
    callback: Callback | None = None,
) -> OptimizeResult:
    """Maximise an objective within bounds with a particle swarm; see `minimise`."""
    return _run(Objective(fun, vectorized, sign=1.0), bounds, method, seed, max_evaluations, options, callback)


@dataclass(slots=True)
class _Record:
    """The best value so far and its history. Larger values are better."""

    x: np.ndarray
    value: float = -np.inf
    history: list[float] = field(default_factory=list)
    history_nfev: list[int] = field(default_factory=list)

    def add(self, population: Population, nfev: int) -> None:
        best = int(np.argmax(population.local_values))
        if population.local_values[best] > self.value:
            self.x, self.value = population.local_bests[best].copy(), float(population.local_values[best])
        self.history.append(self.value)
        self.history_nfev.append(nfev)

    def result(self, objective: Objective, success: bool, message: str, **more: Any) -> OptimizeResult:
        # Slow to import, and robots, which use other parts of this package, do not need it.
        from scipy.optimize import OptimizeResult

        return OptimizeResult(
            x=self.x.copy(),
            fun=objective.sign * self.value,
            nfev=objective.nfev,
            nit=max(0, len(self.history) - 1),
            history=objective.sign * np.array(self.history),
            history_nfev=np.array(self.history_nfev, dtype=np.int64),
            success=success,
            message=message,
            **more,
        )


def _run(
    objective: Objective,
    bounds: Sequence[tuple[float, float]] | ArrayLike,
    method: str,
    seed: int | np.random.Generator,
    max_evaluations: int,
    options: Options | None,
    callback: Callback | None,
) -> OptimizeResult:
    low, high = _limits(bounds)
    options = _options_of(method, options)
    check_whole("max_evaluations", max_evaluations)
    if not isinstance(seed, np.random.Generator):
        check_whole("seed", seed)
    rng = seed if isinstance(seed, np.random.Generator) else stream(seed, "swarm optimiser")
    sizes = _sizes(options)
    num_particles = sizes.initial_swarms * sizes.initial_particles
    if max_evaluations < num_particles:
        raise ValueError(f"max_evaluations must be at least the {num_particles} particles, got {max_evaluations}")
    population = start(rng.uniform(low, high, (num_particles, len(low))), sizes.initial_swarms, options)
    record = _Record(population.positions[0].copy())
    while True:
        try:
            improved = _evaluate(population, objective)
        except UndefinedValue as error:
            return record.result(objective, False, str(error))
        record.add(population, objective.nfev)
        if callback is not None and _is_stopped_by(callback, record, objective, population):
            return record.result(objective, False, "the callback ended the run")
        if isinstance(options, DpsoOptions):
            select_particles(population, improved, sizes, low, high, rng)
        elif isinstance(options, RdpsoOptions):
            select_robots(population, improved, sizes, rng)
        if objective.nfev + len(population.positions) > max_evaluations:
            return record.result(objective, True, f"{objective.nfev} of {max_evaluations} evaluations are used up")
        move(population, options, low, high, rng)


def _evaluate(population: Population, objective: Objective) -> set[int]:
    """Evaluate all positions; return the swarms that improved, and OUTSIDE if the excluded robots did."""
    outside = population.members(OUTSIDE)
    best_before = np.max(population.local_values[outside], initial=-np.inf)
    improved = population.take_values(objective(population.positions))
    if np.max(population.local_values[outside], initial=-np.inf) > best_before:
        improved.add(OUTSIDE)
    return improved


def _is_stopped_by(callback: Callback, record: _Record, objective: Objective, population: Population) -> bool:
    places = {"positions": population.positions.copy(), "swarm_ids": population.swarm_ids.copy()}
    try:
        return bool(callback(record.result(objective, True, "running", **places)))
    except StopIteration:
        return True


def _options_of(method: str, options: Options | None) -> Options:
    if method not in OPTIONS:
        raise ValueError(f"method must be one of {', '.join(OPTIONS)}, got {method!r}")
    wanted = OPTIONS[method]
    if options is None:
        return wanted()
    if type(options) is not wanted:
        raise ValueError(f"method {method!r} takes {wanted.__name__}, got {type(options).__name__}")
    return options


def _sizes(options: Options) -> SwarmSizes:
    """Return the sizes; a PSO is one swarm that no particle leaves."""
    if isinstance(options, DpsoOptions | RdpsoOptions):
        return options.sizes
    num = options.num_particles
    return SwarmSizes(1, 1, 1, min_particles=num, initial_particles=num, max_particles=num)


def _limits(bounds: Sequence[tuple[float, float]] | ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    try:
        pairs = np.array(bounds, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"bounds must be a (low, high) of numbers for each dimension, got {bounds!r}") from error
    if pairs.ndim != 2 or pairs.shape[1] != 2 or len(pairs) == 0:
        raise ValueError(f"bounds must have shape (dimensions, 2), got {pairs.shape}")
    for dimension, (low, high) in enumerate(pairs.tolist()):
        if not (np.isfinite(low) and np.isfinite(high) and low < high and np.isfinite(high - low)):
            raise ValueError(f"bounds of dimension {dimension} must be finite with low < high, got ({low}, {high})")
    return pairs[:, 0].copy(), pairs[:, 1].copy()
