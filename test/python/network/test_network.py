"""The network of a team, step by step."""

import itertools
import math

import numpy as np
import pytest
from placed import PlacedNetwork
from recurrence import connectivity_matrix

from robotteamsim import rng
from robotteamsim.network import Network, newly_endangered
from robotteamsim.network.messages import EVERYBODY, Batch, Inbox, Message, batch_of
from robotteamsim.propagation import RadioField
from robotteamsim.scenario.floor_plan import Bounds, Door, FloorPlan, Wall
from robotteamsim.scenario.sections import Network as NetworkSection
from robotteamsim.scenario.sections import Radio

_IN_A_ROW = np.array([[0.0, 5.0], [70.0, 5.0], [140.0, 5.0]])
"""Neighbours at 70 m: -90.2 dBm; ends at 140 m: -97.2 dBm."""
_SILENT = [(), (), ()]


def _network(num_robots: int = 3, **keys) -> Network:
    radio_field = RadioField(FloorPlan(name="field", bounds=Bounds(max=(200.0, 10.0))), Radio())
    return PlacedNetwork(radio_field, NetworkSection(**keys), num_robots)


def test_links_hops_and_breaks_of_three_robots_in_a_row():
    state, _ = _network().step(_IN_A_ROW, _SILENT)
    assert state.rssi_dbm[0, 1] == pytest.approx(-(47.4 + 23.2 * math.log10(70.0)))
    assert np.array_equal(state.link, state.rssi_dbm)
    assert state.adjacency.tolist() == [[False, True, False], [True, False, True], [False, True, False]]
    assert state.hop_count.tolist() == [[0, 1, 2], [1, 0, 1], [2, 1, 0]]
    assert not state.break_matrix.any()
    assert state.fiedler_value == pytest.approx(1.0)
    assert state.swarm_connectivity == pytest.approx(1 / 3)


def test_split_team_has_breaks_and_fiedler_value_zero():
    state, _ = _network(lost_below_dbm=-85.0).step(np.array([[0.0, 5.0], [5.0, 5.0], [140.0, 5.0]]), _SILENT)
    assert state.fiedler_value == 0.0
    assert state.hop_count[0, 2] == -1
    assert state.break_matrix[0, 2] == state.rssi_dbm[0, 2]
    assert state.break_matrix[0, 1] == 0.0


def test_link_is_endangered_between_the_two_thresholds():
    state, _ = _network().step(np.array([[0.0, 5.0], [20.0, 5.0], [50.0, 5.0]]), _SILENT)
    assert state.adjacency[0].tolist() == [False, True, True]
    assert state.endangered.tolist() == [[False, False, True], [False, False, True], [True, True, False]]
    assert state.num_endangered == 2


def test_version_of_the_links_stays_until_one_comes_or_goes():
    network = _network()
    weak = np.array([[0.0, 5.0], [20.0, 5.0], [50.0, 5.0]])
    first, moved, nearer = (network.step(weak - shift, _SILENT)[0] for shift in ([0, 0], [0.001, 0], [0, 0]))
    assert first.version == moved.version == nearer.version
    gone, _ = network.step(weak * [0.1, 1.0], _SILENT)
    assert gone.version > first.version
    assert not gone.endangered.any()
    assert first.endangered.any()


def test_link_becomes_endangered_when_it_falls_below_the_threshold_lost_or_not():
    # Signal of link 0-1 from step to step: weak, good, weak, lost, weak, good, lost, robot 1 leaves, comes back weak.
    levels = ["weak", "good", "weak", "lost", "weak", "good", "lost", "gone", "weak", "good", "gone"]
    pair = np.array([[False, True], [True, False]])
    adjacency = np.array([pair & (level in ("weak", "good")) for level in levels])
    endangered = np.array([pair & (level == "weak") for level in levels])
    hops = np.array([np.diag([0, -1 if level == "gone" else 0]) for level in levels])
    found = newly_endangered(adjacency, endangered, hops)
    assert np.flatnonzero(found[:, 0, 1]).tolist() == [0, 2, 6, 8]
    assert np.array_equal(found, found.transpose(0, 2, 1))


def test_lost_link_is_not_endangered():
    state, _ = _network().step(_IN_A_ROW, _SILENT)
    assert not state.endangered[0, 2]


def test_link_exists_down_to_the_threshold_itself():
    loss_db = 47.4 + 23.2 * math.log10(70.0)
    assert _network(2, lost_below_dbm=-loss_db).step(_IN_A_ROW[:2], [(), ()])[0].adjacency[0, 1]
    assert not _network(2, lost_below_dbm=-loss_db + 1e-9).step(_IN_A_ROW[:2], [(), ()])[0].adjacency[0, 1]


def test_links_by_distance_ignore_the_signal():
    state, _ = _network(link="distance", max_distance_m=70.0).step(_IN_A_ROW, _SILENT)
    assert state.link.tolist() == [[0.0, 70.0, 140.0], [70.0, 0.0, 70.0], [140.0, 70.0, 0.0]]
    assert state.hop_count[0].tolist() == [0, 1, 2]


def test_messages_travel_over_several_hops():
    message = Message(0, 2, "hello")
    _, inboxes = _network().step(_IN_A_ROW, [(message,), (), ()])
    assert inboxes == [(), (), (message,)]


def test_messages_do_not_cross_a_split():
    outboxes = [(Message(0, 2, "a"), Message(0, EVERYBODY, "b")), (), ()]
    _, inboxes = _network(lost_below_dbm=-85.0).step(np.array([[0.0, 5.0], [5.0, 5.0], [140.0, 5.0]]), outboxes)
    assert inboxes == [(), (outboxes[0][1],), ()]


def test_inbox_is_sorted_by_sender_then_by_order_of_sending():
    outboxes = [
        (Message(0, EVERYBODY, "z"), Message(0, 2, "a")),
        (Message(1, 2, "m"), Message(1, EVERYBODY, "b")),
        (Message(2, EVERYBODY, "c"),),
    ]
    _, inboxes = _network().step(_IN_A_ROW, outboxes)
    assert [m.payload for m in inboxes[2]] == ["z", "a", "m", "b"]
    assert [m.payload for m in inboxes[0]] == ["b", "c"]


def test_nobody_receives_his_own_messages():
    _, inboxes = _network().step(_IN_A_ROW, [(Message(0, 0, "me"), Message(0, EVERYBODY, "all")), (), ()])
    assert inboxes[0] == ()


def test_topology_follows_links_that_come_and_go():
    network = _network()
    apart = np.array([[0.0, 5.0], [5.0, 5.0], [199.0, 5.0]])
    together = network.step(_IN_A_ROW, _SILENT)[0]
    assert network.step(apart, _SILENT)[0].fiedler_value == 0.0
    again = network.step(_IN_A_ROW, _SILENT)[0]
    assert again.fiedler_value == together.fiedler_value
    assert np.array_equal(again.hop_count, together.hop_count)


def test_version_grows_with_links_and_with_who_is_present():
    network = _network()
    apart = np.array([[0.0, 5.0], [5.0, 5.0], [199.0, 5.0]])
    versions = [network.step(positions_m, _SILENT)[0].version for positions_m in (_IN_A_ROW, _IN_A_ROW, apart)]
    for present in ([True, True, False], [False, False, False], [True, True, True]):
        network.follow_team(np.array(present))
        versions.append(network.step(apart, _SILENT)[0].version)
    first, again, *later = versions
    assert first == again
    assert sorted({again, *later}) == [again, *later]


def test_closed_door_can_cut_a_link():
    plan = FloorPlan(
        name="rooms",
        bounds=Bounds(max=(10.0, 10.0)),
        walls=(
            Wall(name="low", start=(5.0, 0.0), end=(5.0, 4.0)),
            Wall(name="high", start=(5.0, 5.0), end=(5.0, 10.0)),
        ),
        doors=(Door(name="gate", start=(5.0, 4.0), end=(5.0, 5.0), kind="fireproof"),),
    )
    radio_field = RadioField(plan, Radio())
    network = PlacedNetwork(radio_field, NetworkSection(endangered_below_dbm=-60.0, lost_below_dbm=-70.0), 2)
    positions_m = np.array([[2.0, 4.5], [8.0, 4.5]])
    assert network.step(positions_m, [(), ()])[0].fiedler_value == pytest.approx(2.0)
    radio_field.set_door("gate", True)
    assert network.step(positions_m, [(), ()])[0].fiedler_value == 0.0


def test_single_robot_is_a_network():
    state, inboxes = _network(1).step(np.array([[3.0, 3.0]]), [(Message(0, EVERYBODY, "x"),)])
    assert state.swarm_connectivity == 1.0
    assert inboxes == [()]


@pytest.mark.parametrize(
    ("positions_m", "outboxes", "message"),
    [
        (_IN_A_ROW[:2], _SILENT, r"^the state must have 3 robots, got 2$"),
        (_IN_A_ROW, [(), ()], r"^outboxes must have one sequence per robot: 3, got 2$"),
        (_IN_A_ROW + math.inf, _SILENT, r"^position of robot 0 must be finite"),
        (_IN_A_ROW, [(Message(1, 2, ""),), (), ()], r"^outbox of robot 0 contains a message from sender 1$"),
        (_IN_A_ROW, [(Message(0, 3, ""),), (), ()], r"^outbox of robot 0: receiver 3 does not exist; expected 0..2"),
    ],
)
def test_wrong_input_is_rejected(positions_m, outboxes, message):
    with pytest.raises(ValueError, match=message):
        _network().step(positions_m, outboxes)


@pytest.mark.parametrize("width_m", [400.0, 60.0])  # a few islands, or one
def test_broadcasts_arrive_as_if_each_were_asked_about_alone(width_m):
    generator = np.random.default_rng(4)
    for _ in range(30):
        positions_m = generator.uniform((0.0, 0.0), (width_m, 10.0), (12, 2))
        outboxes = [
            tuple(Message(i, EVERYBODY, f"{i}.{k}") for k in range(generator.integers(0, 3))) for i in range(12)
        ]
        state, inboxes = _network(12).step(positions_m, outboxes)
        sent = [message for outbox in outboxes for message in outbox]
        assert inboxes == [
            tuple(message for message in sent if state.hop_count[message.sender, receiver] > 0)
            for receiver in range(12)
        ]


@pytest.mark.parametrize("link", ["signal", "distance"])
def test_links_of_wandering_robots_are_those_of_the_definitions_in_every_step(link):
    network, generator, hops_seen = _network(8, link=link), rng.stream(3, "wander", link), []
    versions: list[int] = []
    positions_m = generator.uniform((20.0, 1.0), (180.0, 9.0), (8, 2))
    section, others = NetworkSection(link=link), ~np.eye(8, dtype=bool)
    for _ in range(60):
        state, _ = network.step(positions_m, [()] * 8)
        apart_m = np.hypot(*(positions_m[:, None] - positions_m[None]).transpose(2, 0, 1))
        assert np.array_equal(state.link, apart_m if link == "distance" else state.rssi_dbm)
        near = apart_m <= section.max_distance_m if link == "distance" else state.rssi_dbm >= section.lost_below_dbm
        assert np.array_equal(state.adjacency, near & others)
        assert np.array_equal(state.endangered, near & others & (state.rssi_dbm < section.endangered_below_dbm))
        hops = connectivity_matrix(state.adjacency)
        hops[(hops == 0) & others] = -1
        assert np.array_equal(state.hop_count, hops)
        assert np.array_equal(state.break_matrix, np.where(hops < 0, state.link, 0.0))
        laplacian = np.diag(state.adjacency.sum(axis=0)) - state.adjacency
        assert state.fiedler_value == pytest.approx(np.linalg.eigvalsh(laplacian)[1], abs=1e-9)
        versions.append(state.version)
        hops_seen.append(state.hop_count)
        positions_m = np.clip(positions_m + generator.normal(0.0, 1.5, (8, 2)), 0.5, (199.5, 9.5))
    kept = [before == now for before, now in itertools.pairwise(versions)]
    assert any(kept)
    assert not all(kept)
    pairs = zip(itertools.pairwise(hops_seen), kept, strict=True)
    assert all(np.array_equal(before, now) for (before, now), is_kept in pairs if is_kept)
    assert not hops_seen[-1].flags.writeable


def test_robot_that_is_not_there_counts_in_no_figure():
    positions_m = np.array([[0.0, 5.0], [np.nan, np.nan], [70.0, 5.0], [140.0, 5.0]])
    present = np.array([True, False, True, True])
    network = _network(4)
    network.follow_team(present)
    among, _ = network.step(positions_m, [()] * 4)
    alone, _ = _network(3).step(_IN_A_ROW, _SILENT)
    assert (among.fiedler_value, among.swarm_connectivity) == (alone.fiedler_value, alone.swarm_connectivity)
    for name in ("rssi_dbm", "link", "adjacency", "hop_count", "break_matrix", "endangered"):
        matrix = getattr(among, name)
        assert matrix.dtype == getattr(alone, name).dtype
        assert np.array_equal(matrix[np.ix_(present, present)], getattr(alone, name))
    assert among.hop_count[1].tolist() == [-1] * 4
    assert not among.adjacency[:, 1].any()
    assert not among.break_matrix[1].any()
    assert np.isneginf(among.rssi_dbm[1]).all()


def test_network_of_nobody_has_no_link():
    network = _network()
    network.follow_team(np.zeros(3, dtype=bool))
    state, inboxes = network.step(np.full((3, 2), np.nan), _SILENT)
    assert (state.fiedler_value, state.swarm_connectivity, state.num_endangered) == (0.0, 0.0, 0)
    assert not state.adjacency.any()
    assert inboxes == [(), (), ()]


def test_links_are_computed_again_when_a_robot_leaves():
    network = _network()
    network.follow_team(np.array([True, False, True]))
    split, _ = network.step(_IN_A_ROW, _SILENT)
    network.follow_team(np.array([True, True, False]))
    near, _ = network.step(_IN_A_ROW, _SILENT)
    assert (split.fiedler_value, near.fiedler_value) == (0.0, pytest.approx(2.0))


def test_broadcasts_count_as_cut_off_only_for_robots_present():
    outboxes = [(Message(0, EVERYBODY, "all"), Message(0, 1, "you")), (), ()]
    network = _network()
    network.follow_team(np.array([True, False, True]))
    state, inboxes = network.step(_IN_A_ROW, outboxes)
    assert inboxes == [(), (), ()]
    assert (state.traffic.delivered, state.traffic.cut_off) == (0, 2)


def test_last_words_of_a_robot_that_goes_reach_nobody():
    outboxes = [(), (Message(1, EVERYBODY, "help"),), ()]
    network = _network()
    network.follow_team(np.array([True, False, True]))
    state, inboxes = network.step(_IN_A_ROW, outboxes)
    assert inboxes == [(), (), ()]
    assert state.traffic.cut_off == 2


def test_robots_that_hear_each_other_share_a_batch_and_miss_their_own_messages():
    positions_m = np.array([[0.0, 0.0], [10.0, 0.0], [20.0, 0.0], [100.0, 0.0], [110.0, 0.0]])
    outboxes = [tuple(Message(i, EVERYBODY, f"{i} {j}") for j in range(i % 3)) for i in range(5)]
    _, inboxes = _network(5, link="distance", max_distance_m=15.0).step(positions_m, outboxes)
    assert inboxes[0].batch is inboxes[1].batch is inboxes[2].batch
    assert inboxes[3].batch is inboxes[4].batch
    expected = [["1 0", "2 0", "2 1"], ["2 0", "2 1"], ["1 0"], ["4 0"], []]
    assert [[message.payload for message in inbox] for inbox in inboxes] == expected
    assert [len(inbox) for inbox in inboxes] == [3, 2, 1, 1, 0]
    assert inboxes[0][-1] == outboxes[2][1]
    assert inboxes[0][:2] == (outboxes[1][0], outboxes[2][0])


def test_inbox_equals_the_sequence_of_its_messages():
    messages = tuple(Message(i, EVERYBODY, str(i)) for i in range(3))
    inbox = Inbox(Batch(messages), 1, 2)
    assert inbox == (messages[0], messages[2]) == tuple(inbox)
    assert inbox != messages
    assert batch_of(inbox).messages == messages
    assert batch_of([messages[0]]).messages == messages[:1]
