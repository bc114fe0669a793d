"""Hops, breaks and connectivity of a team's graph."""

import math

import networkx
import numpy as np
import pytest
from recurrence import connectivity_matrix

from robotteamsim.network import fiedler_value, hop_count

TABLE_4 = np.array(
    [
        [0, 1, 0, 0, 1, 0, 0, 0],
        [1, 0, 1, 0, 1, 0, 0, 0],
        [0, 1, 0, 0, 0, 0, 0, 0],
        [0, 0, 0, 0, 1, 1, 0, 0],
        [1, 1, 0, 1, 0, 0, 0, 0],
        [0, 0, 0, 1, 0, 0, 0, 1],
        [0, 0, 0, 0, 0, 0, 0, 1],
        [0, 0, 0, 0, 0, 1, 1, 0],
    ],
    dtype=bool,
)
TABLE_5 = np.array(
    [
        [0, 1, 2, 2, 1, 3, 5, 4],
        [1, 0, 1, 2, 1, 3, 5, 4],
        [2, 1, 0, 3, 2, 4, 6, 5],
        [2, 2, 3, 0, 1, 1, 3, 2],
        [1, 1, 2, 1, 0, 2, 4, 3],
        [3, 3, 4, 1, 2, 0, 2, 1],
        [5, 5, 6, 3, 4, 2, 0, 1],
        [4, 4, 5, 2, 3, 1, 1, 0],
    ]
)
PATH_3 = np.array([[0, 1, 0], [1, 0, 1], [0, 1, 0]], dtype=bool)
SPLIT_4 = np.array([[0, 1, 0, 0], [1, 0, 0, 0], [0, 0, 0, 1], [0, 0, 1, 0]], dtype=bool)


def _random_graphs() -> list[np.ndarray]:
    generator = np.random.default_rng(11)
    graphs = []
    for n in (2, 3, 5, 9, 20):
        for density in (0.1, 0.3, 0.7):
            upper = np.triu(generator.random((n, n)) < density, 1)
            graphs.append(upper | upper.T)
    return graphs


def _complete(n: int) -> np.ndarray:
    return ~np.eye(n, dtype=bool)


def test_table_5_follows_from_table_4_by_search():
    assert np.array_equal(hop_count(TABLE_4), TABLE_5)


def test_table_5_follows_from_table_4_by_the_recurrence():
    assert np.array_equal(connectivity_matrix(TABLE_4), TABLE_5)


def test_table_5_follows_from_table_4_by_networkx():
    lengths = dict(networkx.all_pairs_shortest_path_length(networkx.from_numpy_array(TABLE_4)))
    assert [[lengths[i][j] for j in range(8)] for i in range(8)] == TABLE_5.tolist()


@pytest.mark.parametrize("adjacency", _random_graphs())
def test_search_recurrence_and_networkx_agree(adjacency):
    hops = hop_count(adjacency)
    assert hops.dtype == np.int32
    assert np.array_equal(np.where(hops < 0, 0, hops), connectivity_matrix(adjacency))
    lengths = dict(networkx.all_pairs_shortest_path_length(networkx.from_numpy_array(adjacency)))
    n = len(adjacency)
    assert [[lengths[i].get(j, -1) for j in range(n)] for i in range(n)] == hops.tolist()


@pytest.mark.parametrize("n", [0, 1, 65, 130, 257])
@pytest.mark.parametrize("degree", [1.0, 3.0, 20.0])
def test_hops_of_larger_teams_are_those_of_networkx(n, degree):
    upper = np.triu(np.random.default_rng(12).random((n, n)) < degree / max(n, 1), 1)
    adjacency = upper | upper.T
    lengths = dict(networkx.all_pairs_shortest_path_length(networkx.from_numpy_array(adjacency)))
    assert [[lengths[i].get(j, -1) for j in range(n)] for i in range(n)] == hop_count(adjacency).tolist()


@pytest.mark.slow
def test_hops_along_a_row_of_150_robots_are_those_of_the_recurrence():
    path = np.eye(150, k=1, dtype=bool) | np.eye(150, k=-1, dtype=bool)
    assert np.array_equal(hop_count(path), connectivity_matrix(path))
    assert hop_count(path)[0, 149] == 149


@pytest.mark.parametrize("adjacency", [g for g in _random_graphs() if len(g) > 2])
def test_fiedler_value_agrees_with_networkx(adjacency):
    graph = networkx.from_numpy_array(adjacency)
    assert fiedler_value(adjacency) == pytest.approx(networkx.laplacian_spectrum(graph)[1], abs=1e-9)
    assert (fiedler_value(adjacency) > 0.0) == networkx.is_connected(graph)


@pytest.mark.parametrize(("n", "degree"), [(60, 6.0), (200, 8.0), (200, 60.0), (500, 12.0), (500, 250.0)])
def test_fiedler_value_of_larger_teams_is_that_of_all_eigenvalues(n, degree):
    upper = np.triu(np.random.default_rng(13).random((n, n)) < degree / n, 1)
    adjacency = upper | upper.T | np.eye(n, k=1, dtype=bool) | np.eye(n, k=-1, dtype=bool)
    laplacian = np.diag(adjacency.sum(axis=1).astype(float)) - adjacency
    assert fiedler_value(adjacency) == pytest.approx(np.linalg.eigvalsh(laplacian)[1], rel=1e-9)


def test_fiedler_value_of_three_robots_in_a_row_is_one():
    assert fiedler_value(PATH_3) == pytest.approx(1.0)
    assert fiedler_value(PATH_3) / 3 == pytest.approx(0.333, abs=5e-4)


def test_fiedler_value_of_twelve_robots_in_a_row_is_small_but_above_zero():
    path = np.eye(12, k=1, dtype=bool) | np.eye(12, k=-1, dtype=bool)
    assert fiedler_value(path) == pytest.approx(2.0 - 2.0 * math.cos(math.pi / 12))
    assert fiedler_value(path) / 12 == pytest.approx(0.0057, abs=5e-5)


@pytest.mark.parametrize("n", [1, 2, 3, 10])
def test_fiedler_value_of_a_complete_graph_is_its_number_of_robots(n):
    assert fiedler_value(_complete(n)) == pytest.approx(n)


def test_fiedler_value_is_exactly_zero_when_the_team_is_split():
    assert fiedler_value(SPLIT_4) == 0.0
    assert fiedler_value(np.zeros((5, 5), dtype=bool)) == 0.0


@pytest.mark.parametrize(
    ("adjacency", "message"),
    [
        (np.zeros((2, 3)), r"adjacency must be square, got shape \(2, 3\)"),
        (np.zeros(4), r"adjacency must have shape \(n, n\), got \(4,\)"),
        (np.array([[0, 1], [0, 0]]), r"adjacency must be symmetric, but is not at \(0, 1\)"),
        (np.eye(2), r"adjacency must be 0 on the diagonal, got 1 at \(0, 0\)"),
    ],
)
def test_matrix_that_is_not_an_undirected_graph_is_rejected(adjacency, message):
    for function in (hop_count, fiedler_value):
        with pytest.raises(ValueError, match=message):
            function(adjacency)


def test_fiedler_value_of_no_robots_is_rejected():
    with pytest.raises(ValueError, match="at least one robot"):
        fiedler_value(np.zeros((0, 0), dtype=bool))
