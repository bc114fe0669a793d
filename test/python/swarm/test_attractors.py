import numpy as np
import pytest

from robotteamsim.swarm import communication_attractor, communication_weight, obstacle_attractor

CANDIDATES_M = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])


def test_obstacle_attractor_is_the_candidate_farthest_from_the_hits():
    hits_m = np.array([[1.5, 0.0], [0.0, 1.4]])
    assert obstacle_attractor((0.0, 0.0), hits_m, CANDIDATES_M) == (0.0, -1.0)


def test_obstacle_attractor_is_the_robot_itself_where_nothing_was_hit():
    assert obstacle_attractor((0.3, 0.4), np.empty((0, 2)), CANDIDATES_M) == (0.3, 0.4)


def test_obstacle_attractor_is_the_own_position_at_the_best_clearance():
    ring_m = np.array([[np.cos(a), np.sin(a)] for a in np.linspace(0, 2 * np.pi, 37)])
    assert obstacle_attractor((0.0, 0.0), ring_m, 0.5 * ring_m) == (0.0, 0.0)
    assert obstacle_attractor((0.0, 0.0), ring_m, np.empty((0, 2))) == (0.0, 0.0)


def test_first_of_equal_candidates_is_taken():
    assert obstacle_attractor((0.0, 0.0), np.array([[2.0, 0.0]]), CANDIDATES_M) == (0.0, 1.0)


def test_communication_attractor_is_one_range_from_the_neighbour():
    assert communication_attractor((10.0, 0.0), (0.0, 0.0), 25.0) == (25.0, 0.0)
    assert communication_attractor((30.0, 40.0), (0.0, 0.0), 25.0) == pytest.approx((15.0, 20.0))


def test_robot_on_its_neighbour_stays():
    assert communication_attractor((1.0, 2.0), (1.0, 2.0), 25.0) == (1.0, 2.0)


@pytest.mark.parametrize(
    ("proximity", "weight"), [(1.0, 0.0), (0.5, 0.0), (0.3, 0.0), (0.15, 0.2), (0.03, 0.36), (0.0, 0.4)]
)
def test_communication_weight_grows_from_the_endangered_to_the_lost_link(proximity, weight):
    assert communication_weight(0.4, proximity, 0.3, connected=True) == pytest.approx(weight)


def test_communication_weight_is_full_in_a_split_swarm():
    assert communication_weight(0.4, 1.0, 0.3, connected=False) == 0.4


def test_obstacle_attractor_is_that_of_all_distances_in_numpy():
    generator = np.random.default_rng(3)
    for _ in range(200):
        hits_m, candidates_m = generator.uniform(-1.0, 1.0, (20, 2)), generator.uniform(-1.0, 1.0, (9, 2))
        places_m = np.vstack([(0.1, 0.2), candidates_m])
        clearances_m = np.linalg.norm(places_m[:, None] - hits_m[None], axis=2).min(axis=1)
        assert obstacle_attractor((0.1, 0.2), hits_m, candidates_m) == tuple(places_m[clearances_m.argmax()].tolist())


def test_obstacle_attractor_is_the_first_of_equal_candidates():
    hits_m = np.array([[0.5, 0.0]])
    assert obstacle_attractor((0.4, 0.0), hits_m, np.array([[0.0, 0.0], [1.0, 0.0]])) == (0.0, 0.0)
    assert obstacle_attractor((0.0, 0.0), hits_m, np.array([[1.0, 0.0]])) == (0.0, 0.0)
