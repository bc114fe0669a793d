import numpy as np
import pytest

from robotteamsim.swarm import DpsoOptions, RdpsoOptions, SwarmSizes, SwarmState
from robotteamsim.swarm.population import OUTSIDE, Population, start
from robotteamsim.swarm.selection import select_particles, select_robots

LOW, HIGH = np.zeros(2), np.ones(2)


class Draws:
    """A generator that gives the numbers it was made with, and what else is asked for from a seeded one."""

    def __init__(self, *numbers: float) -> None:
        self._numbers = list(numbers)
        self._other = np.random.default_rng(1)

    def random(self):
        return self._numbers.pop(0)

    def uniform(self, low, high):
        return (low + high) / 2.0

    def integers(self, number):
        return self._other.integers(number)

    def choice(self, family, number, replace):
        return self._other.choice(family, number, replace=replace)


def swarms(values: list[list[float]], options) -> Population:
    """Return swarms whose particles have these values; all stand where their index says."""
    flat = np.concatenate([np.array(v) for v in values])
    population = start(np.repeat(np.arange(float(len(flat)))[:, None], 2, axis=1), len(values), options)
    population.take_values(flat)
    return population


def sizes_of(population):
    return {swarm_id: len(population.members(swarm_id)) for swarm_id in population.swarms}


def test_dpso_swarm_with_success_gets_a_particle_and_forgets_its_failures():
    sizes = SwarmSizes(1, 1, 1, 2, 3, 4)
    population = swarms([[1.0, 2.0, 3.0]], DpsoOptions(sizes=sizes))
    population.swarms[0].state = SwarmState(2, 3)
    select_particles(population, {0}, sizes, LOW, HIGH, Draws())
    assert population.swarms[0].state == SwarmState(0, 0)
    assert population.positions[-1].tolist() == [0.5, 0.5]
    assert population.local_values[-1] == -np.inf
    select_particles(population, {0}, sizes, LOW, HIGH, Draws())
    assert sizes_of(population) == {0: 4}


def test_dpso_swarm_without_success_loses_its_worst_particle_and_waits_shorter_for_the_next():
    sizes = SwarmSizes(1, 1, 1, 2, 4, 4, search_counter_max=4)
    population = swarms([[1.0, 0.5, 3.0, 2.0]], DpsoOptions(sizes=sizes))
    sizes_after = []
    for _ in range(6):
        select_particles(population, set(), sizes, LOW, HIGH, Draws())
        sizes_after.append(len(population.positions))
    # SC: 1 2 3 4, (12) sets it to 4 (1 - 1/2) = 2, 3 4
    assert sizes_after == [4, 4, 4, 3, 3, 2]
    assert population.local_values.tolist() == [3.0, 2.0]


def test_dpso_swarm_below_its_minimum_is_deleted_but_never_the_last():
    sizes = SwarmSizes(1, 2, 2, 3, 3, 3, search_counter_max=1)
    population = swarms([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], DpsoOptions(sizes=sizes))
    for _ in range(3):
        select_particles(population, set(), sizes, LOW, HIGH, Draws(0.0, 0.9))
    assert sizes_of(population) == {1: 3}
    assert population.local_values.tolist() == [4.0, 5.0, 6.0]


@pytest.mark.parametrize(("draw", "children"), [(0.29, 1), (0.31, 0)])
def test_eq_13_by_hand(draw, children):
    # f = 0.6 with two swarms: 0.3. The second swarm draws f = 0.
    sizes = SwarmSizes(1, 2, 3, 2, 4, 4)
    population = swarms([[1.0, 2.0, 3.0, 4.0], [5.0, 6.0, 7.0, 8.0]], DpsoOptions(sizes=sizes))
    select_particles(population, set(), sizes, LOW, HIGH, Draws(0.6, draw, 0.0, 0.5))
    assert len(population.swarms) == 2 + children


def test_child_has_half_of_its_particles_from_its_parent_and_half_from_the_mate():
    sizes = SwarmSizes(1, 2, 3, 2, 4, 4)
    population = swarms([[1.0, 2.0, 3.0, 4.0], [5.0, 6.0, 7.0, 8.0]], DpsoOptions(sizes=sizes))
    select_particles(population, set(), sizes, LOW, HIGH, Draws(1.0, 0.0))
    child = population.local_values[population.members(2)]
    assert sorted(child <= 4.0) == [False, False, True, True]
    assert len(set(child.tolist())) == 4
    assert population.swarms[2].value == child.max()
    assert population.swarms[2].state == SwarmState()
    assert sizes_of(population) == {0: 4, 1: 4, 2: 4}


def test_dpso_swarm_that_lost_particles_has_no_child():
    sizes = SwarmSizes(1, 1, 3, 2, 4, 4)
    population = swarms([[1.0, 2.0, 3.0, 4.0]], DpsoOptions(sizes=sizes))
    population.swarms[0].state = SwarmState(0, 1)
    select_particles(population, set(), sizes, LOW, HIGH, Draws())
    assert len(population.swarms) == 1


def test_worst_robot_is_excluded_and_the_best_excluded_one_called_in_by_the_next_swarm_with_success():
    sizes = SwarmSizes(1, 2, 2, 0, 3, 4, search_counter_max=1)
    population = swarms([[1.0, 9.0, 3.0], [4.0, 5.0, 6.0]], RdpsoOptions(sizes=sizes))
    select_robots(population, set(), sizes, Draws())
    assert population.swarm_ids.tolist() == [OUTSIDE, 0, 0, OUTSIDE, 1, 1]
    # Swarm 0 lost one robot: it calls with chance 1/2, and then founds no swarm, for there are two.
    select_robots(population, {0}, sizes, Draws(0.4))
    assert population.swarm_ids.tolist() == [OUTSIDE, 0, 0, 0, OUTSIDE, 1]


def test_robot_that_joins_brings_its_best_along():
    sizes = SwarmSizes(1, 1, 1, 0, 3, 4)
    population = swarms([[1.0, 2.0, 3.0]], RdpsoOptions(sizes=sizes))
    population.swarm_ids[0] = OUTSIDE
    population.local_values[0] = 7.0
    select_robots(population, {0}, sizes, Draws(0.0))
    assert population.swarms[0].value == 7.0
    assert sizes_of(population) == {0: 3}


def test_swarm_at_its_minimum_is_dissolved_unless_too_few_would_be_left():
    sizes = SwarmSizes(1, 2, 2, 3, 3, 4, search_counter_max=1)
    population = swarms([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], RdpsoOptions(sizes=sizes))
    select_robots(population, set(), sizes, Draws())
    assert population.swarm_ids.tolist() == [OUTSIDE] * 3 + [1] * 3
    assert population.swarms[1].state == SwarmState(0, 0)


@pytest.mark.parametrize(("draw", "founded"), [(0.24, True), (0.26, False)])
def test_swarm_is_founded_by_the_best_excluded_with_a_chance_that_grows_with_who_asks(draw, founded):
    # f = 0.5 and 2 of at most 4 robots: 1/4
    sizes = SwarmSizes(1, 1, 2, 0, 2, 4)
    population = swarms([[1.0, 2.0, 3.0, 4.0, 5.0]], RdpsoOptions(sizes=sizes))
    population.swarm_ids[:] = [0, OUTSIDE, OUTSIDE, OUTSIDE, 0]
    # The first draw is for calling one in: 0.9 * (3 + 1) is above 1.
    population.swarms[0].state = SwarmState(0, 3)
    select_robots(population, {0}, sizes, Draws(0.9, 0.5, draw))
    assert population.swarm_ids.tolist() == ([0, OUTSIDE, 1, 1, 0] if founded else [0, OUTSIDE, OUTSIDE, OUTSIDE, 0])


def test_excluded_robots_whose_best_improves_found_a_swarm_where_none_is_left():
    sizes = SwarmSizes(0, 1, 2, 0, 2, 4, search_counter_max=1)
    population = swarms([[1.0, 2.0]], RdpsoOptions(sizes=sizes))
    for _ in range(2):
        select_robots(population, set(), sizes, Draws())
    assert population.swarm_ids.tolist() == [OUTSIDE, OUTSIDE]
    assert sizes_of(population) in ({}, {0: 0})
    select_robots(population, {OUTSIDE}, sizes, Draws(1.0, 0.0))
    assert (population.swarm_ids >= 0).all()
