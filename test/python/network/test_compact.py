from __future__ import annotations

import numpy as np
import pytest
from placed import PlacedNetwork
from robotteamsim._core.state import State

from robotteamsim.network import NetworkState, newly_endangered
from robotteamsim.network.compact import CompactLinks, LinksEncoder, hops_among, unpacked
from robotteamsim.propagation import RadioField
from robotteamsim.scenario import load

NUM_ROBOTS, NUM_STEPS = 60, 25
SENT = ("adjacency", "endangered", "hop_count")


@pytest.fixture(scope="module")
def networks() -> list[NetworkState]:
    """A team of which some leave and return, in a garage where links break around corners."""
    scenario = load("garage_sar")
    network = PlacedNetwork(RadioField(scenario.plan, scenario.radio), scenario.network, NUM_ROBOTS)
    generator = np.random.default_rng(3)
    positions_m = generator.uniform((1.0, 1.0), (59.0, 39.0), (NUM_ROBOTS, 2))
    states = []
    for step in range(NUM_STEPS):
        if 8 <= step <= 16:
            network.follow_team(generator.random(NUM_ROBOTS) < (0.9 if step < 16 else 1.0))
        states.append(network.step(positions_m, [()] * NUM_ROBOTS)[0])
        if step != 4:
            positions_m = np.clip(positions_m + generator.normal(0.0, 0.8, positions_m.shape), 1.0, 39.0)
    return states


@pytest.fixture(scope="module")
def links(networks: list[NetworkState]) -> list[CompactLinks]:
    encoder = LinksEncoder()
    return [encoder.encode(network) for network in networks]


def test_unpacked_links_equal_the_matrices(networks, links):
    assert len({network.adjacency.tobytes() for network in networks}) > NUM_STEPS / 2
    assert any(network.endangered.any() for network in networks)
    for network, sent in zip(networks, links, strict=True):
        adjacency, endangered = unpacked(sent.adjacency, NUM_ROBOTS), unpacked(sent.endangered, NUM_ROBOTS)
        for name, got in zip(SENT, (adjacency, endangered, hops_among(adjacency, sent.present)), strict=True):
            expected = getattr(network, name)
            assert got.dtype == expected.dtype, name
            np.testing.assert_array_equal(got, expected, err_msg=name)
        assert sent.fiedler_value == network.fiedler_value
        assert sent.swarm_connectivity == network.swarm_connectivity
        assert sent.num_endangered == network.num_endangered


def test_link_that_weakens_has_its_signal(networks, links):
    adjacency, endangered, hops = (np.stack([getattr(state, name) for state in networks]) for name in SENT)
    weakened = np.argwhere(newly_endangered(adjacency, endangered, hops))
    assert len(weakened) > 100
    sent = [
        {(i, j): rssi_dbm for (i, j), rssi_dbm in zip(one.weakened.tolist(), one.weakened_rssi_dbm, strict=True)}
        for one in links
    ]
    for step, i, j in weakened:
        assert sent[step][min(i, j), max(i, j)] == networks[step].rssi_dbm[i, j]


def test_step_without_a_change_has_no_weakened_links(networks):
    encoder = LinksEncoder()
    first, again = (encoder.encode(networks[0]) for _ in range(2))
    assert (len(first.weakened), len(again.weakened)) == (first.num_endangered, 0)
    assert again.adjacency is first.adjacency


def test_links_of_a_thousand_robots_take_a_quarter_of_a_megabyte():
    n = 1000
    state, none = State(n), np.zeros((n, n), bool)
    numbers = {"rssi_dbm": np.zeros((n, n)), "hop_count": np.zeros((n, n), np.int32)}
    state.put_links(adjacency=none, endangered=none, fiedler_value=0.0, version=1, **numbers)
    links = LinksEncoder().encode(NetworkState(state))
    assert links.present.nbytes + links.adjacency.nbytes + links.endangered.nbytes == 251_000


def test_links_in_one_direction_are_rejected(links):
    one_way = links[0].adjacency.copy()
    one_way[0, 0] ^= 2
    with pytest.raises(ValueError, match="symmetric"):
        hops_among(unpacked(one_way, NUM_ROBOTS), links[0].present)
