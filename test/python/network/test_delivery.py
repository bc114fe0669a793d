"""Messages hop by hop: routes, delays, losses, sizes, partitions."""

from __future__ import annotations

import networkx
import numpy as np
import pytest
from placed import PlacedNetwork
from scipy.stats import binomtest

from robotteamsim import rng
from robotteamsim.network import EVERYBODY, Message, Network, Refusal, Traffic, hop_count, loss_probability, next_hop
from robotteamsim.propagation import RadioField
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan
from robotteamsim.scenario.sections import Network as NetworkSection
from robotteamsim.scenario.sections import Radio

STEP_NS = 100_000_000
ROW_M = np.array([[70.0 * i, 5.0] for i in range(5)])
"""Neighbours at 70 m, -90.2 dBm: each robot reaches the next one only."""


def _network(num_robots: int, seed: int = 1, **keys) -> Network:
    radio_field = RadioField(FloorPlan(name="field", bounds=Bounds(max=(900.0, 900.0))), Radio())
    return PlacedNetwork(radio_field, NetworkSection(**keys), num_robots, seed=seed, step_ns=STEP_NS)


def _distance_m(rssi_dbm: float) -> float:
    return 10.0 ** ((-47.4 - rssi_dbm) / 23.2)


def _silence(num_robots: int) -> list[tuple[Message, ...]]:
    return [()] * num_robots


def _arrivals(network: Network, positions_m: np.ndarray, message: Message, steps: int) -> dict[int, int]:
    """Send one message and return in which step it arrived at whom."""
    n = len(positions_m)
    outboxes = [(message,) if robot_id == message.sender else () for robot_id in range(n)]
    arrived = {}
    for step in range(1, steps + 1):
        _, inboxes = network.step(positions_m, outboxes if step == 1 else _silence(n))
        for robot_id, inbox in enumerate(inboxes):
            assert inbox in ((), (message,))
            if inbox:
                assert robot_id not in arrived
                arrived[robot_id] = step
    return arrived


def _random_positions_m(seed: int, num_robots: int = 14) -> np.ndarray:
    return np.random.default_rng(seed).uniform(0.0, 450.0, (num_robots, 2))


def test_a_hop_takes_its_delay_and_broadcasts_arrive_by_hop_count():
    assert _arrivals(_network(5, hop_delay_s=0.2), ROW_M, Message(1, EVERYBODY, "x"), 9) == {0: 2, 2: 2, 3: 4, 4: 6}


def test_a_message_to_one_robot_takes_the_delay_of_its_path():
    assert _arrivals(_network(5, hop_delay_s=0.15), ROW_M, Message(0, 3, "x"), 9) == {3: 5}  # 0.45 s


def test_hops_shorter_than_a_step_arrive_with_the_first_step_that_is_late_enough():
    assert _arrivals(_network(5, hop_delay_s=0.05), ROW_M, Message(0, EVERYBODY, "x"), 9) == {1: 1, 2: 1, 3: 2, 4: 2}


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("receiver", ["everybody", "one by one"])
def test_reached_robots_and_delays_equal_the_shortest_paths_of_networkx(seed, receiver):
    positions_m = _random_positions_m(seed)
    adjacency = _network(14).step(positions_m, _silence(14))[0].adjacency
    lengths = networkx.single_source_shortest_path_length(networkx.from_numpy_array(adjacency), 0)
    expected = {robot_id: hops for robot_id, hops in lengths.items() if robot_id}
    assert len(expected) < 13 or seed
    arrived = {}
    for to in [EVERYBODY] if receiver == "everybody" else range(1, 14):
        arrived.update(_arrivals(_network(14, hop_delay_s=0.1), positions_m, Message(0, to, "x"), 15))
    assert arrived == expected


@pytest.mark.parametrize("seed", range(6))
def test_next_hops_lead_along_a_shortest_path_of_networkx(seed):
    state, _ = _network(14).step(_random_positions_m(seed), _silence(14))
    graph = networkx.from_numpy_array(state.adjacency)
    for sender in range(14):
        for receiver in range(14):
            path = [sender]
            while (
                path[-1] != receiver and (robot := next_hop(state.hop_count, state.rssi_dbm, path[-1], receiver)) >= 0
            ):
                path.append(robot)
            if networkx.has_path(graph, sender, receiver):
                assert path in list(networkx.all_shortest_paths(graph, sender, receiver))
            else:
                assert path == [sender]


def test_among_equally_short_routes_the_strongest_link_wins_then_the_lowest_id():
    square = np.array([[0, 1, 1, 0], [1, 0, 0, 1], [1, 0, 0, 1], [0, 1, 1, 0]], dtype=bool)
    rssi_dbm = np.where(square, -60.0, 0.0)
    assert next_hop(hop_count(square), rssi_dbm, 0, 3) == 1
    rssi_dbm[0, 2] = rssi_dbm[2, 0] = -59.0
    assert next_hop(hop_count(square), rssi_dbm, 0, 3) == 2


def test_routes_follow_robots_that_move_while_a_message_is_on_its_way():
    # Robot 1 takes the message and carries it to where only robot 3 leads on to robot 4.
    network = _network(5, hop_delay_s=0.1)
    before = np.array([[0.0, 0.0], [70.0, 0.0], [140.0, 0.0], [140.0, 400.0], [210.0, 0.0]])
    after = np.array([[0.0, 0.0], [70.0, 400.0], [140.0, 0.0], [140.0, 400.0], [210.0, 400.0]])
    assert network.step(before, [(Message(0, 4, "x"),), (), (), (), ()])[1] == [()] * 5
    assert network.step(after, _silence(5))[1] == [()] * 5
    assert network.step(after, _silence(5))[1][4] == (Message(0, 4, "x"),)


def test_message_is_lost_when_its_route_breaks():
    network = _network(5, hop_delay_s=0.1)
    network.step(ROW_M, [(Message(0, 4, "x"),), (), (), (), ()])
    broken = ROW_M + np.array([[0.0, 0.0]] * 3 + [[300.0, 0.0]] * 2)
    state, _ = network.step(broken, _silence(5))
    assert state.traffic == Traffic(lost=1)
    assert network.step(ROW_M, _silence(5))[0].traffic == Traffic()


def test_a_partition_splits_the_messages_received_and_heals():
    network = _network(4, hop_delay_s=0.1)
    apart = np.array([[0.0, 0.0], [50.0, 0.0], [500.0, 0.0], [550.0, 0.0]])
    together = apart - np.array([[0.0, 0.0], [0.0, 0.0], [400.0, 0.0], [400.0, 0.0]])
    outboxes = [(Message(i, EVERYBODY, str(i)),) for i in range(4)]
    state, inboxes = network.step(apart, outboxes)
    assert [[m.sender for m in inbox] for inbox in inboxes] == [[1], [0], [3], [2]]
    assert state.traffic == Traffic(delivered=4, mean_delay_s=0.1)
    state, _ = network.step(apart, _silence(4))  # what is passed on finds nobody
    assert state.traffic == Traffic(cut_off=8)
    network.step(together, outboxes)
    _, inboxes = network.step(together, _silence(4))
    assert [m.sender for m in inboxes[0]] == [3]  # two hops away; the others came in the step before


def test_messages_arrive_sorted_by_sender_then_as_sent():
    network = _network(5, hop_delay_s=0.1)
    network.step(ROW_M, [(Message(0, EVERYBODY, "0a"),), (), (), (), ()])
    _, inboxes = network.step(
        ROW_M, [(Message(0, EVERYBODY, "0b"), Message(0, 1, "0c")), (), (Message(2, 1, "2"),), (), ()]
    )
    assert [m.payload for m in inboxes[1]] == ["0b", "0c", "2"]
    assert [m.payload for m in inboxes[2]] == ["0a"]


def test_loss_rises_linearly_over_the_band_of_signals():
    rssi_dbm = np.array([-60.0, -80.0, -83.5, -87.0, -94.0, -99.0])
    expected = [0.0, 0.0, 0.25, 0.5, 1.0, 1.0]
    assert loss_probability(rssi_dbm, NetworkSection(loss="signal")).tolist() == expected
    assert not loss_probability(rssi_dbm, NetworkSection()).any()
    one = NetworkSection(loss="signal", endangered_below_dbm=-85.0, lost_below_dbm=-85.0)
    assert not loss_probability(rssi_dbm, one).any()


@pytest.mark.slow
@pytest.mark.parametrize("rssi_dbm", [-82.0, -87.0, -92.0])
@pytest.mark.parametrize("receiver", [1, EVERYBODY])
def test_share_of_lost_messages_is_that_of_the_signal(rssi_dbm, receiver):
    network = _network(2, loss="signal")
    positions_m = np.array([[0.0, 0.0], [_distance_m(rssi_dbm), 0.0]])
    outboxes = [(Message(0, receiver, "a"), Message(0, receiver, "b")), ()]
    lost = sum(network.step(positions_m, outboxes)[0].traffic.lost for _ in range(1000))
    assert binomtest(lost, 2000, (-80.0 - rssi_dbm) / 14.0).pvalue > 0.001


@pytest.mark.slow
def test_share_of_messages_lost_over_two_hops_is_that_of_both():
    network = _network(3, loss="signal", lost_below_dbm=-88.0)
    reach_m = _distance_m(-82.0)  # each hop loses a quarter; the ends are at -89 dBm
    positions_m = np.array([[0.0, 0.0], [reach_m, 0.0], [2.0 * reach_m, 0.0]])
    state, _ = network.step(positions_m, _silence(3))
    assert state.hop_count[0].tolist() == [0, 1, 2]
    loss = loss_probability(state.rssi_dbm, NetworkSection(loss="signal", lost_below_dbm=-88.0))
    arrive = (1.0 - loss[0, 1]) * (1.0 - loss[1, 2])
    got = sum(len(network.step(positions_m, [(Message(0, 2, "x"),), (), ()])[1][2]) for _ in range(2000))
    assert binomtest(got, 2000, arrive).pvalue > 0.001


def test_safe_links_lose_nothing():
    network = _network(3, loss="signal")
    outboxes = [(Message(i, EVERYBODY, "x"),) for i in range(3)]
    for _ in range(50):
        state, _ = network.step(np.array([[0.0, 0.0], [10.0, 0.0], [0.0, 10.0]]), outboxes)
        assert (state.traffic.delivered, state.traffic.lost) == (6, 0)


def test_losses_follow_from_seed_step_and_pair_alone():
    positions_m = np.array([[0.0, 0.0], [70.0, 0.0], [0.0, 70.0]])

    def heard(seed: int, *senders: int) -> list[bool]:
        network = _network(3, seed, loss="signal")
        outboxes = [(Message(i, 1, "x"),) if i in senders else () for i in range(3)]
        inboxes = [network.step(positions_m, outboxes)[1][1] for _ in range(40)]
        return [any(m.sender == 0 for m in inbox) for inbox in inboxes]

    alone = heard(1, 0)
    loss = loss_probability(_network(3).step(positions_m, _silence(3))[0].rssi_dbm, NetworkSection(loss="signal"))
    assert alone == [bool(rng.stream(1, "network", step, 0).random(3)[1] >= loss[0, 1]) for step in range(1, 41)]
    assert alone == heard(1, 0, 2)
    assert alone != heard(2, 0)


def test_every_copy_is_delivered_lost_or_cut_off():
    generator = np.random.default_rng(3)
    network = _network(14, loss="signal", hop_delay_s=0.07)
    sent = counted = 0
    for step in range(60):
        outboxes = [
            tuple(Message(i, int(generator.integers(-1, 14)), "x") for _ in range(2 if step < 40 else 0))
            for i in range(14)
        ]
        sent += sum(13 if m.receiver == EVERYBODY else m.receiver != m.sender for box in outboxes for m in box)
        state, inboxes = network.step(_random_positions_m(step // 10), outboxes)
        assert state.traffic.delivered == sum(map(len, inboxes))
        counted += state.traffic.delivered + state.traffic.lost + state.traffic.cut_off
    assert counted == sent


def test_without_delay_and_loss_copies_are_counted_too():
    network = _network(3)
    outboxes = [(Message(0, EVERYBODY, "x"), Message(0, 2, "y"), Message(0, 0, "z")), (), ()]
    state, _ = network.step(np.array([[0.0, 0.0], [50.0, 0.0], [500.0, 0.0]]), outboxes)
    assert state.traffic == Traffic(delivered=1, cut_off=2, mean_delay_s=0.1)


@pytest.mark.parametrize("keys", [{}, {"loss": "signal", "hop_delay_s": 0.1}])
def test_a_message_that_is_too_large_is_rejected_and_the_others_travel(keys):
    network = _network(2, max_message_bytes=10, **keys)
    fits, large, wide = Message(0, 1, "0123456789"), Message(0, 1, "01234567890"), Message(1, EVERYBODY, "ä" * 6)
    state, inboxes = network.step(np.array([[0.0, 0.0], [5.0, 0.0]]), [(large, fits), (wide,)])
    assert inboxes == [(), (fits,)]
    assert state.traffic.refused == (Refusal(0, 11, 10), Refusal(1, 12, 10))
    assert state.traffic.delivered == 1


def test_message_that_is_carried_by_a_robot_that_goes_is_cut_off():
    network = _network(5, hop_delay_s=0.1)
    network.step(ROW_M, [(Message(0, 4, "on"),), (), (), (), ()])
    network.step(ROW_M, _silence(5))
    network.follow_team(np.array([True, True, False, True, True]))
    state, _ = network.step(ROW_M, _silence(5))
    assert (state.traffic.delivered, state.traffic.lost + state.traffic.cut_off) == (0, 1)


def test_flood_with_losses_is_due_only_to_robots_present():
    network = _network(5, hop_delay_s=0.1)
    network.follow_team(np.array([True, True, True, False, True]))
    outboxes = [(Message(0, EVERYBODY, "all"),), (), (), (), ()]
    states = [network.step(ROW_M, outboxes)[0]]
    states += [network.step(ROW_M, _silence(5))[0] for _ in range(5)]
    assert sum(state.traffic.delivered for state in states) == 2
    assert sum(state.traffic.cut_off for state in states) == 1
