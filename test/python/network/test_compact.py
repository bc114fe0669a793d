from __future__ import annotations

import math

import numpy as np
import pytest

from robotteamsim.network import Network, NetworkState, newly_endangered
from robotteamsim.network.compact import CompactLinks, LinksDecoder, LinksEncoder
from robotteamsim.propagation import RadioField
from robotteamsim.scenario import load

NUM_ROBOTS, NUM_STEPS = 60, 25
SENT = ("adjacency", "endangered", "hop_count")


@pytest.fixture(scope="module")
def networks() -> list[NetworkState]:
    """A team of which some leave and return, in a garage where links break around corners."""
    scenario = load("garage_sar")
    network = Network(RadioField(scenario.plan, scenario.radio), scenario.network, NUM_ROBOTS)
    generator = np.random.default_rng(3)
    positions_m = generator.uniform((1.0, 1.0), (59.0, 39.0), (NUM_ROBOTS, 2))
    states = []
    for step in range(NUM_STEPS):
        present = generator.random(NUM_ROBOTS) < 0.9 if 8 <= step < 16 else None
        states.append(network.step(positions_m, [()] * NUM_ROBOTS, present)[0])
        if step != 4:
            positions_m = np.clip(positions_m + generator.normal(0.0, 0.8, positions_m.shape), 1.0, 39.0)
    return states


def restored(networks: list[NetworkState]) -> list[NetworkState]:
    encoder, decoder = LinksEncoder(), LinksDecoder()
    return [decoder.decode(encoder.encode(network)) for network in networks]


def test_restored_links_equal_the_matrices(networks):
    assert len({network.adjacency.tobytes() for network in networks}) > NUM_STEPS / 2
    assert any(network.endangered.any() for network in networks)
    for network, back in zip(networks, restored(networks), strict=True):
        for name in SENT:
            expected, got = getattr(network, name), getattr(back, name)
            assert got.dtype == expected.dtype, name
            np.testing.assert_array_equal(got, expected, err_msg=name)
        assert back.fiedler_value == network.fiedler_value
        assert back.swarm_connectivity == network.swarm_connectivity
        assert back.num_endangered == network.num_endangered


def test_link_that_weakens_has_its_signal(networks):
    back = restored(networks)
    adjacency, endangered, hops = (np.stack([getattr(state, name) for state in networks]) for name in SENT)
    weakened = newly_endangered(adjacency, endangered, hops)
    assert weakened.sum() > 100
    for step, i, j in np.argwhere(weakened):
        assert back[step].rssi_dbm[i, j] == networks[step].rssi_dbm[i, j]
    assert np.isnan(back[-1].rssi_dbm).any()


def test_step_without_a_change_has_no_weakened_links(networks):
    encoder = LinksEncoder()
    first, again = (encoder.encode(networks[0]) for _ in range(2))
    assert (len(first.weakened), len(again.weakened)) == (first.num_endangered, 0)
    assert again.adjacency is first.adjacency


def test_links_of_a_thousand_robots_take_a_quarter_of_a_megabyte():
    n = 1000
    matrix = np.zeros((n, n))
    network = NetworkState(matrix, matrix, matrix > 0, matrix.astype(np.int32), matrix, 0.0, matrix > 0)
    links = LinksEncoder().encode(network)
    assert links.present.nbytes + links.adjacency.nbytes + links.endangered.nbytes == 251_000


def test_links_in_one_direction_are_rejected(networks):
    links = LinksEncoder().encode(networks[0])
    one_way = links.adjacency.copy()
    one_way[0, 0] ^= 2
    changed = {name: getattr(links, name) for name in CompactLinks.__struct_fields__} | {"adjacency": one_way}
    with pytest.raises(ValueError, match="symmetric"):
        LinksDecoder().decode(CompactLinks(**changed))


def test_signal_that_was_not_sent_is_not_a_number(networks):
    encoder, decoder = LinksEncoder(), LinksDecoder()
    encoder.encode(networks[0])
    assert math.isnan(decoder.decode(encoder.encode(networks[0])).rssi_dbm.min())
