import numpy as np
import pytest

from robotteamsim.swarm import CommunicationTerm, DpsoOptions, ObstacleTerm, PsoOptions, RdpsoOptions, RpsoOptions
from robotteamsim.swarm.adaptation import Levels
from robotteamsim.swarm.population import OUTSIDE, Population, Swarm, move, start

LOW, HIGH = np.full(2, -10.0), np.full(2, 10.0)
MOVES = [(0.5, -0.25), (1.0, 0.0), (0.0, 2.0), (2.0, 2.0)]
EQUAL = {"c1": 1.0, "c2": 1.0, "max_step": 1.0}


class Half:
    """A generator whose numbers are all one half."""

    def random(self, shape):
        return np.full(shape, 0.5)

    def uniform(self, low, high, shape):
        return np.broadcast_to((low + high) / 2.0, shape)


def one_particle(terms=1) -> Population:
    """Return a particle at (1, 2) with its best at (2, 2), in a swarm with its best at (3, 0)."""
    return Population(
        positions=np.array([[1.0, 2.0]]),
        local_bests=np.array([[2.0, 2.0]]),
        local_values=np.array([0.0]),
        moves=np.array(MOVES[:terms])[:, None, :],
        swarm_ids=np.array([0]),
        swarms={0: Swarm(np.array([3.0, 0.0]), 1.0)},
    )


def step(options, terms=1) -> list[float]:
    """Return the particle's velocity v[t+1]."""
    population = one_particle(terms)
    move(population, options, LOW, HIGH, Half())
    assert population.positions[0] == pytest.approx(np.array([1.0, 2.0]) + population.moves[0, 0])
    return population.moves[0, 0].tolist()


def obstacle_above(positions):
    """Return an obstacle that drives all robots to (1, 4)."""
    return ObstacleTerm(np.full_like(positions, (1.0, 4.0)), np.ones(len(positions)))


def lost_neighbour(positions):
    """Return a network that is split, and draws all robots to (-1, 2)."""
    return CommunicationTerm(np.full_like(positions, (-1.0, 2.0)), np.zeros(len(positions)), 0.0)


def near_neighbour(positions):
    return CommunicationTerm(np.full_like(positions, (-1.0, 2.0)), np.full(len(positions), 0.9), 1.0)


@pytest.mark.parametrize("options", [PsoOptions, DpsoOptions])
def test_eq_11_by_hand(options):
    # v + 1/2 (x_LB - x) + 1/2 (x_GB - x) = (0.5 + 0.5 + 1, -0.25 + 0 - 1)
    assert step(options(inertia=1.0, **EQUAL)) == pytest.approx([2.0, -1.25])


def test_eq_14_by_hand():
    assert step(PsoOptions(inertia=0.5, **EQUAL)) == pytest.approx([1.75, -1.125])


def test_eq_15_by_hand():
    # the obstacle term adds 0.5 * 1/2 * (0, 2)
    options = RpsoOptions(inertia=0.5, c3=0.5, obstacles=obstacle_above, **EQUAL)
    assert step(options) == pytest.approx([1.75, -0.625])


def test_eq_22_by_hand():
    # the communication term adds 0.4 * 1/2 * (-2, 0)
    options = RdpsoOptions(
        memory="inertia", inertia=0.5, c3=0.5, c4=0.4, obstacles=obstacle_above, communication=lost_neighbour, **EQUAL
    )
    assert step(options) == pytest.approx([1.35, -0.625])


@pytest.mark.parametrize(
    ("mode", "inertia"),
    [
        # 1/2, 1/4, 1/24, 1/64 of the moves
        ("published", (0.5 * 0.5 + 0.25 + 2 / 64, -0.25 * 0.5 + 2 / 24 + 2 / 64)),
        # 1/2, 1/8, 1/16, 5/128 of the moves
        ("grunwald_letnikov", (0.5 * 0.5 + 1 / 8 + 10 / 128, -0.25 * 0.5 + 2 / 16 + 10 / 128)),
    ],
)
def test_eq_25_by_hand_in_both_modes(mode, inertia):
    expected = [inertia[0] + 1.5, inertia[1] - 1.0]
    for options in (RdpsoOptions, DpsoOptions, PsoOptions, RpsoOptions):
        assert step(options(memory=mode, alpha=0.5, **EQUAL), terms=4) == pytest.approx(expected)


def test_adapted_coefficients_move_the_particle():
    # The robot is social (it is the farthest: S = 0, no), at rest by its mean: alpha 0.9 or 0.3 by |v| / v_max.
    levels = Levels(alpha_small=0.5, alpha_nominal=0.5, alpha_large=0.5, c2_share_small=0.5, c2_share_large=0.5)
    adapted = RdpsoOptions(adaptation="crisp", levels=levels, max_step=1.0)
    assert step(adapted, terms=4) == pytest.approx(step(RdpsoOptions(alpha=0.5, **EQUAL), terms=4))
    both = {"obstacles": obstacle_above, "communication": lost_neighbour}
    # c3 = c4 = 0.8, so c1 = c2 = 0.2
    fixed = RdpsoOptions(alpha=0.5, c1=0.2, c2=0.2, c3=0.8, c4=0.8, max_step=1.0, **both)
    adapted = RdpsoOptions(adaptation="crisp", levels=levels, max_step=1.0, **both)
    assert step(adapted, terms=4) == pytest.approx(step(fixed, terms=4))


def test_communication_term_is_silent_where_the_link_is_good():
    alone = step(RdpsoOptions(**EQUAL), terms=4)
    assert step(RdpsoOptions(communication=near_neighbour, **EQUAL), terms=4) == alone


def test_velocity_is_limited_in_each_dimension():
    # 5 % of a width of 20
    assert step(PsoOptions(inertia=1.0, c1=1.0, c2=1.0, max_step=0.05)) == pytest.approx([1.0, -1.0])


def test_particle_stops_at_the_bounds_and_remembers_what_it_really_moved():
    population = one_particle()
    move(population, PsoOptions(inertia=1.0, **EQUAL), np.array([-10.0, 1.5]), np.array([1.25, 10.0]), Half())
    assert population.positions.tolist() == [[1.25, 1.5]]
    assert population.moves[0].tolist() == [[0.25, -0.5]]


def test_moves_are_remembered_newest_first():
    population = one_particle(terms=4)
    move(population, RdpsoOptions(**EQUAL), LOW, HIGH, Half())
    assert population.moves[1:, 0].tolist() == [list(v) for v in MOVES[:3]]


def test_excluded_robot_wanders_within_the_speed_limit_whatever_the_bests():
    population = one_particle(terms=4)
    population.swarm_ids[:] = OUTSIDE
    generator = np.random.default_rng(1)
    moved = set()
    for _ in range(20):
        move(population, RdpsoOptions(c1=4.0, c2=4.0, max_step=0.05), LOW, HIGH, generator)
        assert np.abs(population.moves[0]).max() <= 1.0
        moved.add(tuple(np.sign(population.moves[0, 0]).tolist()))
    assert len(moved) == 4


def test_one_random_number_for_all_dimensions_moves_a_resting_particle_straight_to_its_best():
    population = start(np.array([[1.0, 2.0]]), 1, PsoOptions())
    population.swarms[0].best = np.array([3.0, -2.0])
    move(population, PsoOptions(random_per_dimension=False), LOW, HIGH, np.random.default_rng(4))
    x, y = population.moves[0, 0]
    assert y == pytest.approx(-2.0 * x)


def test_bests_are_kept_and_shared_within_a_swarm_alone():
    population = start(np.arange(8.0).reshape(4, 2), 2, DpsoOptions())
    assert population.take_values(np.array([1.0, 3.0, 2.0, 0.0])) == {0, 1}
    assert [swarm.value for swarm in population.swarms.values()] == [3.0, 2.0]
    population.positions = population.positions + 1.0
    assert population.take_values(np.array([2.0, 3.0, 2.0, 5.0])) == {1}
    assert population.local_values.tolist() == [2.0, 3.0, 2.0, 5.0]
    assert population.local_bests[:, 0].tolist() == [1.0, 2.0, 4.0, 7.0]
    assert population.swarms[1].best.tolist() == [7.0, 8.0]


@pytest.mark.parametrize(
    ("attractors", "metric", "message"),
    [
        (np.zeros((1, 3)), np.zeros(1), r"obstacles must return attractors of shape \(1, 2\).*got \(1, 3\)"),
        (np.full((1, 2), np.nan), np.zeros(1), r"obstacles: robot 0 of the swarm got attractor \[nan, nan\]"),
        (
            np.zeros((1, 2)),
            np.array([1.5]),
            r"obstacles: robot 0 .* metric 1.5; expected finite numbers, and a metric within \[0, 1\]",
        ),
    ],
)
def test_wrong_sensing_is_refused(attractors, metric, message):
    options = RpsoOptions(obstacles=lambda _: ObstacleTerm(attractors, metric))
    with pytest.raises(ValueError, match=message):
        step(options)
