"""Options of the methods: coefficients, memory, sizes of swarms, terms of robots."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from robotteamsim.swarm.adaptation import EXACT_LEVELS, PUBLISHED_LEVELS, WEIGHT_SUM, Adaptation, Levels
from robotteamsim.swarm.memory import MemoryMode, memory_coefficients

FRACTIONAL_ORDER = {"inertia": 0.8, "published": 0.45, "grunwald_letnikov": 0.8}
"""Fractional orders with which a swarm comes to rest; see the figure in docs/swarm.md."""

_RDPSO_WEIGHTS = (1.49618, 1.49618, 0.5, 0.5)

COEFFICIENT_MAX = 4.0
"""Beyond c1 + c2 = 4 no inertia within [0, 1] keeps the swarm together, so a larger value is a typing error."""


def _check_range(name: str, value: float, high: float) -> None:
    if not isinstance(value, float | int | np.number):
        raise ValueError(f"{name} must be a number, got {value!r}")
    if not (math.isfinite(value) and 0.0 <= value <= high):
        raise ValueError(f"{name} must lie in [0, {high:g}], got {value}")


def check_whole(name: str, value: int) -> None:
    """Raise ValueError unless a value is a whole number; True is not one."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise ValueError(f"{name} must be a whole number, got {value!r}")


def _check_count(name: str, value: int, low: int) -> None:
    check_whole(name, value)
    if value < low:
        raise ValueError(f"{name} must be at least {low}, got {value}")


@dataclass(frozen=True, slots=True)
class ObstacleTerm:
    """The obstacles sensed by a swarm's robots.

    attractors: x_OB of (15), shape (robots, dimensions).  avoidance: O_n of (30), shape (robots,); c3 acts if it is
    above 0.
    """

    attractors: np.ndarray
    avoidance: np.ndarray


@dataclass(frozen=True, slots=True)
class CommunicationTerm:
    """The network of a swarm's robots, as they know it.

    attractors: x_CB of (22), shape (robots, dimensions).  proximity: P_n of (31) or (32), shape (robots,).
    connectivity: C_s of (34).
    """

    attractors: np.ndarray
    proximity: np.ndarray
    connectivity: float


SenseObstacles = Callable[[np.ndarray], ObstacleTerm]
"""A function of the positions of one swarm, shape (robots, dimensions)."""
SenseNetwork = Callable[[np.ndarray], CommunicationTerm]


@dataclass(frozen=True, slots=True, kw_only=True)
class Motion:
    """How particles of all kinds move; see PsoOptions."""

    c1: float = 1.49618
    c2: float = 1.49618
    memory: Literal["inertia"] | MemoryMode = "inertia"
    inertia: float = 0.7298
    alpha: float | None = None
    memory_terms: int = 4
    max_step: float = 0.5
    random_per_dimension: bool = True


@dataclass(frozen=True, slots=True)
class PsoOptions(Motion):
    """PSO: (11) with inertia = 1, (14) with less, fractional with another `memory`.

    The defaults of inertia, c1 and c2 are those of the constriction factor [clerc2002].

    memory: of past velocities: `inertia` (w times the last one), or a fractional memory (23, 24) of order alpha
    (default: FRACTIONAL_ORDER), truncated after memory_terms.
    max_step: limit of the velocity in each dimension, as a fraction of the bounds' width.
    random_per_dimension: whether r1..r4 are drawn for each dimension, or once for all dimensions as on robots.
    Raises: ValueError: a value is outside its range; the message names it.
    """

    num_particles: int = 30

    def __post_init__(self) -> None:
        _check_count("num_particles", self.num_particles, 1)
        _check_motion(self)


@dataclass(frozen=True, slots=True)
class RpsoOptions(PsoOptions):
    """RPSO (15): PSO with an obstacle term. c3: its weight.  obstacles: returns the obstacles; None for no term."""

    c3: float = 0.5
    obstacles: SenseObstacles | None = None

    def __post_init__(self) -> None:
        PsoOptions.__post_init__(self)
        _check_range("c3", self.c3, COEFFICIENT_MAX)


@dataclass(frozen=True, slots=True)
class SwarmSizes:
    """Number of swarms, number of particles (robots) in each, and SC_max of (12).

    Raises: ValueError: not 0 <= min <= initial <= max, or no initial swarm or particle.
    """

    min_swarms: int = 4
    initial_swarms: int = 6
    max_swarms: int = 8
    min_particles: int = 0
    initial_particles: int = 5
    max_particles: int = 15
    search_counter_max: int = 15

    def __post_init__(self) -> None:
        for what in ("swarms", "particles"):
            for part in ("min", "initial", "max"):
                check_whole(f"{part}_{what}", getattr(self, f"{part}_{what}"))
            low, first, high = (int(getattr(self, f"{part}_{what}")) for part in ("min", "initial", "max"))
            if not (0 <= low <= first <= high and first >= 1):
                raise ValueError(
                    f"{what} need 0 <= min <= initial <= max, initial >= 1, got min {low}, initial {first}, max {high}"
                )
        _check_count("search_counter_max", self.search_counter_max, 1)


@dataclass(frozen=True, slots=True)
class DpsoOptions(Motion):
    """DPSO: several swarms that each move by PSO, and natural selection (12, 13). See PsoOptions."""

    sizes: SwarmSizes = SwarmSizes(min_swarms=1, min_particles=3)

    def __post_init__(self) -> None:
        if self.sizes.min_swarms < 1:
            raise ValueError("min_swarms of a DPSO must be at least 1: it cannot continue without swarms")
        _check_motion(self)


@dataclass(frozen=True, slots=True)
class RdpsoOptions(Motion):
    """RDPSO (25): several swarms of robots, with obstacle and communication terms, social exclusion and inclusion.

    The number of robots is constant. See PsoOptions and RpsoOptions; in addition:

    communication: returns the network; None for no term.  c4: its weight, which acts only below `endangered_proximity`.
    adaptation: whether alpha and c1..c4 follow the context by the rules of 5.2.2. They then replace the values given
        here, which must satisfy (26), too, if they are given.
    levels: values of small and large in these rules; by default those for the memory.
    """

    sizes: SwarmSizes = SwarmSizes()
    c3: float = _RDPSO_WEIGHTS[2]
    c4: float = _RDPSO_WEIGHTS[3]
    memory: Literal["inertia"] | MemoryMode = field(default="grunwald_letnikov", kw_only=True)
    obstacles: SenseObstacles | None = None
    communication: SenseNetwork | None = None
    endangered_proximity: float = 0.2
    adaptation: Adaptation = "none"
    levels: Levels | None = None

    def __post_init__(self) -> None:
        _check_motion(self)
        _check_range("c3", self.c3, COEFFICIENT_MAX)
        _check_range("c4", self.c4, COEFFICIENT_MAX)
        if not 0.0 < self.endangered_proximity <= 1.0:
            raise ValueError(f"endangered_proximity must lie in (0, 1], got {self.endangered_proximity}")
        if self.adaptation not in ("none", "crisp", "fuzzy"):
            raise ValueError(f"adaptation must be none, crisp or fuzzy, got {self.adaptation!r}")
        if self.adaptation != "none" and self.memory == "inertia":
            raise ValueError(f"adaptation {self.adaptation!r} sets alpha: it needs a fractional memory, not 'inertia'")
        weights = (self.c1, self.c2, self.c3, self.c4)
        if self.adaptation != "none" and weights != _RDPSO_WEIGHTS and not math.isclose(sum(weights), WEIGHT_SUM):
            demand = f"must be {WEIGHT_SUM:g} with adaptation {self.adaptation!r}, eq. (26)"
            raise ValueError(f"c1 + c2 + c3 + c4 {demand}, got {sum(weights):g}")

    def levels_used(self) -> Levels:
        """Return the given levels, or those for the memory."""
        return self.levels or (PUBLISHED_LEVELS if self.memory == "published" else EXACT_LEVELS)


Options = PsoOptions | DpsoOptions | RpsoOptions | RdpsoOptions


def inertia_coefficients(options: Options) -> tuple[float, ...]:
    """Return the weights of v[t], v[t-1], ... in v[t+1]."""
    if options.memory == "inertia":
        return (options.inertia,)
    return memory_coefficients(options.memory, fractional_order(options), options.memory_terms)


def fractional_order(options: Options) -> float:
    """Return the given alpha, or that for the memory."""
    return FRACTIONAL_ORDER[options.memory] if options.alpha is None else options.alpha


def _check_motion(options: Options) -> None:
    _check_range("c1", options.c1, COEFFICIENT_MAX)
    _check_range("c2", options.c2, COEFFICIENT_MAX)
    _check_range("inertia", options.inertia, 1.0)
    if options.memory not in ("inertia", "published", "grunwald_letnikov"):
        raise ValueError(f"memory must be inertia, published or grunwald_letnikov, got {options.memory!r}")
    check_whole("memory_terms", options.memory_terms)
    if options.alpha is not None:
        _check_range("alpha", options.alpha, 1.0)
    # Alpha and terms are checked even if the inertia replaces them.
    memory_coefficients("grunwald_letnikov", fractional_order(options), options.memory_terms)
    inertia_coefficients(options)
    if not 0.0 < options.max_step <= 1.0:
        raise ValueError(f"max_step must lie in (0, 1], a part of the bounds' width, got {options.max_step}")
