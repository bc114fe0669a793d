"""Natural selection among swarms: DPSO [dissertation, 5.1.2, eq. 12, 13] and RDPSO [5.2.2].

docs/swarm.md lists our choices where the sources are silent.
"""

from collections.abc import Mapping

import numpy as np

from robotteamsim.swarm.exclusion import ExclusionRules, SwarmState, judge, punish, spawn_chance
from robotteamsim.swarm.options import SwarmSizes
from robotteamsim.swarm.population import OUTSIDE, Population


def select_particles(
    population: Population,
    improved: set[int],
    sizes: SwarmSizes,
    low: np.ndarray,
    high: np.ndarray,
    rng: np.random.Generator,
) -> None:
    """Apply the rules of DPSO after an iteration.

    Args: improved: keys of the swarms that improved their global best.
    """
    rules = ExclusionRules(sizes.search_counter_max, sizes.min_particles, sizes.max_particles)
    for swarm_id in sorted(population.swarms):
        swarm, members = population.swarms[swarm_id], population.members(swarm_id)
        if swarm_id in improved:
            swarm.state = SwarmState()
            if len(members) < sizes.max_particles:
                _spawn_particle(population, swarm_id, rng.uniform(low, high))
        else:
            verdict = punish(swarm.state, _values(population, members), rules)
            _dismiss(population, swarm_id, verdict.state, verdict.leaves, sizes.min_swarms)
        if swarm_id not in population.swarms or swarm.state.num_killed > 0:
            continue
        if len(population.swarms) < sizes.max_swarms:
            chance = spawn_chance(rng.random(), len(population.swarms))
            if rng.random() < chance:
                _spawn_child(population, swarm_id, sizes.initial_particles, rng)
    population.delete_outside()


def select_robots(population: Population, improved: set[int], sizes: SwarmSizes, rng: np.random.Generator) -> None:
    """Apply social exclusion and inclusion after an iteration.

    Args: improved: keys of the swarms that improved their global best; contains OUTSIDE if the excluded robots did.
    """
    rules = ExclusionRules(sizes.search_counter_max, sizes.min_particles, sizes.max_particles)
    for swarm_id in sorted(population.swarms):
        swarm, members = population.swarms[swarm_id], population.members(swarm_id)
        outside = _values(population, population.members(OUTSIDE))
        verdict = judge(
            swarm.state, swarm_id in improved, _values(population, members), outside, rules, lambda: float(rng.random())
        )
        _dismiss(population, swarm_id, verdict.state, verdict.leaves, sizes.min_swarms)
        if verdict.joins:
            population.swarm_ids[list(verdict.joins)] = swarm_id
            population.update_global_best(swarm_id)
        if swarm_id in improved and verdict.state.search_counter == 0:
            _found_swarm(population, len(members), sizes, rng)
    if OUTSIDE in improved:
        _found_swarm(population, len(population.members(OUTSIDE)), sizes, rng)


def _values(population: Population, indices: np.ndarray) -> Mapping[int, float]:
    return dict(zip(indices.tolist(), population.local_values[indices].tolist(), strict=True))


def _dismiss(
    population: Population, swarm_id: int, state: SwarmState, leaves: tuple[int, ...], min_swarms: int
) -> None:
    """Move leaving particles OUTSIDE, and dissolve a swarm that all leave, unless too few swarms would be left."""
    population.swarms[swarm_id].state = state
    if not leaves:
        return
    if len(leaves) < len(population.members(swarm_id)):
        population.swarm_ids[list(leaves)] = OUTSIDE
    elif len(population.swarms) > min_swarms:
        population.swarm_ids[list(leaves)] = OUTSIDE
        del population.swarms[swarm_id]
    else:
        population.swarms[swarm_id].state = SwarmState(0, state.num_killed - len(leaves))


def _spawn_particle(population: Population, swarm_id: int, position: np.ndarray) -> None:
    """Add a particle at rest, without any memory."""
    at_rest = np.zeros((len(population.moves), 1, len(position)))
    added = population.append(position[None], position[None], np.array([-np.inf]), at_rest)
    population.swarm_ids[added] = swarm_id


def _spawn_child(population: Population, parent_id: int, num_particles: int, rng: np.random.Generator) -> None:
    """Add a swarm of copies: half of them of the parent's particles, the others of a mate's, drawn at random."""
    mates = [swarm_id for swarm_id in sorted(population.swarms) if swarm_id != parent_id] or [parent_id]
    mate_id = mates[int(rng.integers(len(mates)))]
    chosen = []
    for family_id, wanted in ((parent_id, (num_particles + 1) // 2), (mate_id, num_particles // 2)):
        family = population.members(family_id)
        chosen.append(rng.choice(family, min(wanted, len(family)), replace=False))
    copied = np.concatenate(chosen)
    added = population.append(
        population.positions[copied],
        population.local_bests[copied],
        population.local_values[copied],
        population.moves[:, copied],
    )
    population.new_swarm_of(added)


def _found_swarm(population: Population, num_asking: int, sizes: SwarmSizes, rng: np.random.Generator) -> None:
    """Make a swarm of the best excluded robots, with a probability that grows with the number of requesting robots."""
    outside = population.members(OUTSIDE)
    if len(population.swarms) >= sizes.max_swarms or len(outside) < sizes.initial_particles:
        return
    fraction = rng.random()
    if rng.random() < fraction * min(1.0, num_asking / sizes.max_particles):
        best_first = outside[np.argsort(-population.local_values[outside], kind="stable")]
        population.new_swarm_of(np.sort(best_first[: sizes.initial_particles]))
