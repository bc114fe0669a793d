"""The communication term of one robot, and the places that are ruled out."""

from __future__ import annotations

import ctypes
import gc
import math
import os

import networkx
import numpy as np
import pytest

from robotteamsim.control.rdpso.terms import LinkKeeper, RuledOut, strongest_tree
from robotteamsim.scenario.controllers.base import LinkTuning
from robotteamsim.scenario.controllers.swarms import RdpsoControl
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan, Wall
from robotteamsim.scenario.sections import Network
from robotteamsim.setup import resolve

HERE = (10.0, 50.0)


class _MallInfo(ctypes.Structure):
    """What glibc's mallinfo2 returns: ten numbers, the bytes of mapped blocks as field 4, those in use as field 7."""

    _fields_ = [(f"field_{i}", ctypes.c_size_t) for i in range(10)]


TREE = {"kept_link": "tree"}


@pytest.fixture
def keeper(hall_scenario):
    """Make the link keeper of a robot in a field, with these keys of the control."""

    def make(*walls: Wall, control: dict[str, object] | None = None, **network: object) -> LinkKeeper:
        plan = FloorPlan(name="field", bounds=Bounds(max=(400.0, 100.0)), walls=walls)
        settings = RdpsoControl(**({"c4": 0.4} | (control or {})))
        return LinkKeeper(0, resolve(hall_scenario(plan=plan, control=settings, network=Network(**network))))

    return make


def test_safe_link_does_not_pull(keeper):
    links = keeper()
    # 25.4 m is where free space has -80 dBm.
    assert links.pull(HERE, {1: (35.0, 50.0)}, {})[1] == 0.0
    assert links.pull(HERE, {1: (11.0, 50.0), 2: (300.0, 50.0)}, {})[1] == 0.0


def test_endangered_link_pulls_towards_the_neighbour_and_no_nearer_than_safe(keeper):
    links = keeper()
    (x, y), weight = links.pull(HERE, {1: (50.0, 50.0)}, {})
    assert (50.0 - x, y) == pytest.approx((25.4, 50.0), abs=0.1)
    # -84.6 dBm at 40 m: a third of the way from -80 to -94 dBm.
    assert weight == pytest.approx(0.4 * 0.327, abs=0.002)


def test_link_without_the_gate_pulls_with_its_whole_weight_and_drives_near_robots_apart(keeper):
    # As eq. (22) is printed: from the neighbour 1 m away, 25.4 m in the direction of the robot.
    (x, y), weight = keeper(control={"communication": LinkTuning(gated=False)}).pull(HERE, {1: (11.0, 50.0)}, {})
    assert weight == 0.4
    assert (x, y) == pytest.approx((11.0 - 25.4, 50.0), abs=0.1)


def test_wall_endangers_a_shorter_link_and_still_pulls_together(keeper):
    walls = [Wall(name=f"w{i}", start=(14.0 + i, 40.0), end=(14.0 + i, 60.0)) for i in range(3)]
    links = keeper(*walls)
    (x, _), weight = links.pull(HERE, {1: (28.0, 50.0)}, {})
    assert weight > 0.0
    assert HERE[0] < x < 28.0


def test_member_that_was_not_heard_pulls_with_full_weight(keeper):
    links = keeper()
    (x, y), weight = links.pull(HERE, {1: (11.0, 50.0)}, {2: (210.0, 50.0)})
    assert weight == 0.4
    assert x > HERE[0]
    assert y == 50.0


def test_member_that_is_not_heard_where_its_link_would_be_safe_drives_nobody_away(keeper):
    # Such a member was lost or went elsewhere. The attractor is 25.4 m from its last place, so it would push.
    assert keeper().pull(HERE, {1: (11.0, 50.0)}, {2: (15.0, 50.0)}) == (HERE, 0.0)
    assert keeper().pull(HERE, {}, {2: (15.0, 50.0)}) == (HERE, 0.0)
    # The links to the others are kept as if it were not there.
    assert keeper().pull(HERE, {1: (50.0, 50.0)}, {2: (15.0, 50.0)}) == keeper().pull(HERE, {1: (50.0, 50.0)}, {})
    # As printed, it counts fully.
    printed = keeper(control={"communication": LinkTuning(gated=False)})
    assert printed.pull(HERE, {}, {2: (15.0, 50.0)})[1] == 0.4


def test_robot_alone_is_not_pulled(keeper):
    assert keeper().pull(HERE, {}, {}) == (HERE, 0.0)


def test_link_by_distance_pulls_from_four_fifths_of_the_range(keeper):
    links = keeper(link="distance", max_distance_m=10.0)
    assert links.pull(HERE, {1: (17.9, 50.0)}, {})[1] == 0.0
    (x, _), weight = links.pull(HERE, {1: (19.0, 50.0)}, {})
    assert x == pytest.approx(11.0)
    assert weight == pytest.approx(0.2)


def test_without_c4_no_radio_is_computed(hall_scenario):
    links = LinkKeeper(0, resolve(hall_scenario(control=RdpsoControl(c4=0.0))))
    assert links.pull((3.0, 4.0), {1: (math.inf, 0.0)}, {}) == ((3.0, 4.0), 0.0)


@pytest.fixture
def ruled_out(hall_scenario) -> RuledOut:
    return RuledOut(hall_scenario())


def test_nothing_is_ruled_out_at_first(ruled_out):
    assert not ruled_out.covers((5.0, 5.0))


def test_robot_rules_out_all_around_but_the_loudest_cell(ruled_out):
    ruled_out.add((5.0, 5.0), (6.125, 5.125))
    assert not ruled_out.covers((6.125, 5.125))
    assert ruled_out.covers((6.125, 5.375))
    assert ruled_out.covers((4.0, 5.0))
    assert not ruled_out.covers((6.6, 5.0))


def test_robot_next_to_the_loudest_cell_rules_it_out(ruled_out):
    ruled_out.add((5.0, 5.0), (5.625, 5.125))
    assert ruled_out.covers((5.625, 5.125))


def test_silence_rules_out_everything_around(ruled_out):
    ruled_out.add((5.0, 5.0), None)
    assert ruled_out.covers((6.4, 5.0))
    assert not ruled_out.covers((6.6, 5.0))


@pytest.mark.skipif("ROBOTTEAMSIM_CORE" in os.environ, reason="mallinfo2 knows no allocator of sanitizers")
def test_note_takes_at_most_80_bytes(ruled_out):
    # 40 bytes per note, its hash, its number in a bucket, and two numbers of the hash table: 65. It was 128.
    libc = ctypes.CDLL(None)
    libc.mallinfo2.restype = _MallInfo

    def used() -> int:
        info = libc.mallinfo2()
        return info.field_4 + info.field_7  # mapped, and in use

    gc.collect()
    before, count = used(), 2**16
    for i in range(count):
        ruled_out.add((0.25 * (i % 256), 0.25 * (i // 256)), None if i % 3 else (1.0, 1.0))
    assert 40 <= (used() - before) / count <= 80
    assert ruled_out.covers((60.0, 60.0))


def test_nothing_is_ruled_out_where_that_is_switched_off(hall_scenario):
    printed = RuledOut(hall_scenario(), is_on=False)
    printed.add((5.0, 5.0), None)
    assert not printed.covers((5.0, 5.0))


def test_new_voice_map_rules_out_nothing(ruled_out):
    ruled_out.add((5.0, 5.0), None)
    ruled_out.clear()
    assert not ruled_out.covers((5.0, 5.0))


def test_strongest_tree_is_the_spanning_tree_of_networkx():
    generator = np.random.default_rng(5)
    for n in (2, 3, 8, 20):
        upper = np.triu(generator.uniform(-100.0, -40.0, (n, n)), 1)
        strength = upper + upper.T
        graph = networkx.from_numpy_array(-strength)
        expected = {tuple(sorted(edge)) for edge in networkx.minimum_spanning_edges(graph, data=False)}
        assert {tuple(sorted(link)) for link in strongest_tree(strength)} == expected


def test_tree_keeps_the_link_that_alone_holds_two_groups_together(keeper):
    # Robot 1 is beside this robot; 2 and 3 are far, and their strongest link to the rest is the one to this robot.
    places = {1: (9.0, 50.0), 2: (60.0, 50.0), 3: (61.0, 50.0)}
    assert keeper().pull(HERE, places, {})[1] == 0.0
    (x, y), weight = keeper(control=TREE).pull(HERE, places, {})
    assert weight > 0.0
    assert (60.0 - x, y) == pytest.approx((25.4, 50.0), abs=0.1)


def test_tree_leaves_a_robot_in_peace_whose_own_links_are_safe(keeper):
    # Robot 1 holds the far robot 2; this robot has only its link to robot 1 in the tree.
    assert keeper(control=TREE).pull(HERE, {1: (12.0, 50.0), 2: (60.0, 50.0)}, {})[1] == 0.0


def test_tree_by_distance_is_that_of_the_shortest_links(keeper):
    links = keeper(control=TREE, link="distance", max_distance_m=20.0)
    (x, _), weight = links.pull(HERE, {1: (9.0, 50.0), 2: (28.0, 50.0)}, {})
    assert weight > 0.0
    assert x == pytest.approx(28.0 - 16.0)


def test_cells_in_reach_are_those_with_a_good_link_to_any_of_the_places(keeper):
    links = keeper()
    within = links.in_reach([(10.5, 50.5), (200.5, 50.5)], 1.0)
    assert within.shape == (100, 400)
    # -84.67 dBm, a third of the way from -80 to -94 dBm, is 40.5 m away in the open.
    assert within[50, [49, 52, 161, 240]].tolist() == [True, False, True, True]
    assert links.in_reach([], 1.0) is None
    by_distance = keeper(link="distance", max_distance_m=10.0)
    assert by_distance.in_reach([(10.5, 50.5)], 1.0)[50, [17, 18, 19]].tolist() == [True, True, False]


def test_without_the_term_no_link_is_asked_for(keeper):
    links = keeper(control=TREE | {"c4": 0.0})
    assert links.in_reach([(10.0, 50.0)], 1.0) is None
    assert links.pull(HERE, {1: (300.0, 50.0)}, {})[1] == 0.0
