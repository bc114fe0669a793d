"""Particles of all swarms in flat arrays, and how they move [dissertation, eq. 11, 14, 15, 22 and 25]."""

from dataclasses import dataclass, field

import numpy as np

from robotteamsim.swarm.adaptation import Coefficients, Context, adapted_coefficients
from robotteamsim.swarm.attractors import communication_weight
from robotteamsim.swarm.exclusion import SwarmState
from robotteamsim.swarm.memory import memory_coefficients, weighted_sum
from robotteamsim.swarm.metrics import robot_socialisation, swarm_activity
from robotteamsim.swarm.options import Options, RdpsoOptions, RpsoOptions, fractional_order, inertia_coefficients
from robotteamsim.swarm.velocity import add_pulls

OUTSIDE = -1
"""Swarm number of socially excluded robots and of deleted particles."""


@dataclass(slots=True)
class Swarm:
    """The memory of a swarm: its global best, shape (dimensions,), its value, and SC and N_kill."""

    best: np.ndarray
    value: float
    state: SwarmState = field(default_factory=SwarmState)


@dataclass(slots=True)
class Population:
    """All particles. Larger values are better.

    positions, local_bests: float64, shape (n, dimensions).  local_values: float64, shape (n,).
    moves: the real motions in the last iterations, newest first; float64, shape (terms, n, dimensions).
    swarm_ids: int, shape (n,): key of `swarms`, or OUTSIDE.
    """

    positions: np.ndarray
    local_bests: np.ndarray
    local_values: np.ndarray
    moves: np.ndarray
    swarm_ids: np.ndarray
    swarms: dict[int, Swarm]

    def members(self, swarm_id: int) -> np.ndarray:
        """Return the indices of a swarm's particles, ascending."""
        return np.flatnonzero(self.swarm_ids == swarm_id)

    def take_values(self, values: np.ndarray) -> set[int]:
        """Update local and global bests with the values at the positions; return the swarms that improved theirs."""
        better = values > self.local_values
        self.local_values = np.where(better, values, self.local_values)
        self.local_bests = np.where(better[:, None], self.positions, self.local_bests)
        return {swarm_id for swarm_id in self.swarms if self.update_global_best(swarm_id)}

    def update_global_best(self, swarm_id: int) -> bool:
        """Update a swarm's global best with the best local best of its members; return whether it improved."""
        members, swarm = self.members(swarm_id), self.swarms[swarm_id]
        if len(members) == 0:
            return False
        best = members[np.argmax(self.local_values[members])]
        if not self.local_values[best] > swarm.value:
            return False
        swarm.best, swarm.value = self.local_bests[best].copy(), float(self.local_values[best])
        return True

    def new_swarm_of(self, indices: np.ndarray) -> int:
        """Make a swarm of existing particles and return its key."""
        swarm_id = max(self.swarms, default=OUTSIDE) + 1
        self.swarm_ids[indices] = swarm_id
        self.swarms[swarm_id] = Swarm(self.positions[indices[0]].copy(), -np.inf)
        self.update_global_best(swarm_id)
        return swarm_id

    def append(
        self, positions: np.ndarray, local_bests: np.ndarray, values: np.ndarray, moves: np.ndarray
    ) -> np.ndarray:
        """Add particles, initially OUTSIDE, and return their indices."""
        first = len(self.positions)
        self.positions = np.concatenate((self.positions, positions))
        self.local_bests = np.concatenate((self.local_bests, local_bests))
        self.local_values = np.concatenate((self.local_values, values))
        self.moves = np.concatenate((self.moves, moves), axis=1)
        self.swarm_ids = np.concatenate((self.swarm_ids, np.full(len(positions), OUTSIDE)))
        return np.arange(first, len(self.positions))

    def delete_outside(self) -> None:
        """Delete the particles that belong to no swarm."""
        kept = self.swarm_ids != OUTSIDE
        self.positions, self.moves = self.positions[kept], self.moves[:, kept]
        self.local_bests, self.local_values = self.local_bests[kept], self.local_values[kept]
        self.swarm_ids = self.swarm_ids[kept]


@dataclass(slots=True)
class Pulls:
    """Inertia, shape (n, dimensions), and for each of the four terms its weights, shape (n, 1), and attractors."""

    inertia: np.ndarray
    weights: list[np.ndarray]
    attractors: list[np.ndarray]


def start(positions: np.ndarray, num_swarms: int, options: Options) -> Population:
    """Return particles at rest, divided into swarms of equal size, before the first evaluation."""
    num, dimensions = positions.shape
    swarm_ids = np.repeat(np.arange(num_swarms), num // num_swarms)
    terms = len(inertia_coefficients(options))
    swarms = {i: Swarm(positions[np.flatnonzero(swarm_ids == i)[0]].copy(), -np.inf) for i in range(num_swarms)}
    values = np.full(num, -np.inf)
    return Population(positions, positions.copy(), values, np.zeros((terms, num, dimensions)), swarm_ids, swarms)


def move(population: Population, options: Options, low: np.ndarray, high: np.ndarray, rng: np.random.Generator) -> None:
    """Move every particle by x[t+1] = x[t] + v[t+1], within the bounds; excluded robots wander.

    Four random numbers are always drawn for a particle (and dimension), so that PSO, RPSO without obstacles and RDPSO
    with one swarm and no excluded robot take the same steps.
    """
    x = population.positions
    num, dimensions = x.shape
    randoms = rng.random((4, num, dimensions if options.random_per_dimension else 1))
    pulls = _pulls(population, options, high - low)
    v = add_pulls(pulls.inertia, x, zip(pulls.weights, randoms, pulls.attractors, strict=True))
    limit = options.max_step * (high - low)
    outside = population.members(OUTSIDE)
    if len(outside):
        v[outside] = rng.uniform(-limit, limit, (len(outside), dimensions))
    # Clip last, because a position just inside may round to outside.
    positions = np.clip(x + np.clip(v, -limit, limit), low, high)
    population.moves = np.concatenate(((positions - x)[None], population.moves[:-1]))
    population.positions = positions


def _pulls(population: Population, options: Options, width: np.ndarray) -> Pulls:
    """Return the terms of each particle; those of particles OUTSIDE are 0."""
    x = population.positions
    inertia = np.zeros_like(x)
    weights = [np.zeros((len(x), 1)) for _ in range(4)]
    attractors = [population.local_bests, x.copy(), x.copy(), x.copy()]
    for swarm_id, swarm in population.swarms.items():
        members = population.members(swarm_id)
        if len(members) == 0:
            continue
        obstacle, communication, c = _terms(population, swarm, members, options, width)
        attractors[1][members] = swarm.best
        if obstacle is not None:
            attractors[2][members] = obstacle
        if communication is not None:
            attractors[3][members] = communication
        for weight, values in zip(weights, (c.c1, c.c2, c.c3, c.c4), strict=True):
            weight[members, 0] = values
        past = population.moves[:, members]
        inertia[members] = weighted_sum(_memory(options, c.alpha), past)
    return Pulls(inertia, weights, attractors)


def _memory(options: Options, alpha: np.ndarray) -> tuple[float, ...] | tuple[np.ndarray, ...]:
    if isinstance(options, RdpsoOptions) and options.adaptation != "none" and options.memory != "inertia":
        return memory_coefficients(options.memory, alpha[:, None], options.memory_terms)
    return inertia_coefficients(options)


def _terms(
    population: Population, swarm: Swarm, members: np.ndarray, options: Options, width: np.ndarray
) -> tuple[np.ndarray | None, np.ndarray | None, Coefficients]:
    """Return x_OB and x_CB of a swarm's members, None without such a term, and their coefficients."""
    x, num = population.positions[members], len(members)
    none, all_of_it = np.zeros(num), np.ones(num)
    x_ob = x_cb = None
    avoidance, proximity, connectivity = none, all_of_it, 1.0
    if isinstance(options, RpsoOptions | RdpsoOptions) and options.obstacles is not None:
        sensed = options.obstacles(x.copy())
        x_ob, avoidance = sensed.attractors, np.asarray(sensed.avoidance)
    if isinstance(options, RdpsoOptions) and options.communication is not None:
        heard = options.communication(x.copy())
        x_cb, proximity, connectivity = heard.attractors, np.asarray(heard.proximity), heard.connectivity
    _check_terms(x_ob, avoidance, "obstacles", x.shape)
    _check_terms(x_cb, proximity, "communication", x.shape)
    if isinstance(options, RdpsoOptions) and options.adaptation != "none":
        activity = swarm_activity(population.moves[0, members] / width, options.max_step * float(np.sqrt(x.shape[1])))
        social = np.asarray(robot_socialisation(x / width, swarm.best / width, x / width))
        context = Context(activity, social, avoidance, proximity, connectivity)
        return x_ob, x_cb, adapted_coefficients(options.adaptation, context, options.levels_used())
    c3, c4 = none, none
    if x_ob is not None and isinstance(options, RpsoOptions | RdpsoOptions):
        c3 = np.where(avoidance > 0.0, options.c3, 0.0)
    if x_cb is not None and isinstance(options, RdpsoOptions):
        endangered, connected = options.endangered_proximity, connectivity > 0.0
        c4 = np.array([communication_weight(options.c4, p, endangered, connected) for p in proximity.tolist()])
    alpha = np.full(num, fractional_order(options))
    return x_ob, x_cb, Coefficients(alpha, np.full(num, options.c1), np.full(num, options.c2), c3, c4)


def _check_terms(attractors: np.ndarray | None, metric: np.ndarray, name: str, shape: tuple[int, ...]) -> None:
    """Reject values of a user's function with another shape, not finite, or with a metric outside [0, 1]."""
    if attractors is None:
        return
    if np.shape(attractors) != shape or np.shape(metric) != shape[:1]:
        raise ValueError(
            f"{name} must return attractors of shape {shape} and a metric of shape {shape[:1]}, "
            f"got {np.shape(attractors)} and {np.shape(metric)}"
        )
    wrong = ~np.all(np.isfinite(attractors), axis=1) | ~((metric >= 0.0) & (metric <= 1.0))
    if np.any(wrong):
        robot = int(np.argmax(wrong))
        raise ValueError(
            f"{name}: robot {robot} of the swarm got attractor {np.asarray(attractors)[robot].tolist()} "
            f"and metric {metric[robot]}; expected finite numbers, and a metric within [0, 1]"
        )
