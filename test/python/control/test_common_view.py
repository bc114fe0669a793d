"""What robots that heard the same updates conclude from them."""

from __future__ import annotations

from robotteamsim.control.rdpso.team import Best, CommonView, RdpsoUpdate, Sighting
from robotteamsim.interface import OUTSIDE
from robotteamsim.swarm import SwarmState


def update(robot_id: int, swarm_id: int = 0, local_best: Best | None = None, epoch: int = 1, **changes) -> RdpsoUpdate:
    fields = {
        "iteration": 3,
        "position": (float(robot_id), 0.0),
        "loudest": None,
        "known_best": None,
        "swarm": SwarmState(robot_id, 0),
    }
    return RdpsoUpdate(robot_id=robot_id, swarm_id=swarm_id, local_best=local_best, epoch=epoch, **(fields | changes))


def test_each_swarm_has_its_members_and_the_memory_of_the_lowest():
    view = CommonView((update(0, 1), update(1, 0, Best(-2.0, (0.0, 0.0))), update(2, 1), update(3, OUTSIDE)))
    assert view.values == {1: {0: float("-inf"), 2: float("-inf")}, 0: {1: -2.0}, OUTSIDE: {3: float("-inf")}}
    assert view.positions[1] == {0: (0.0, 0.0), 2: (2.0, 0.0)}
    assert {swarm_id: state.search_counter for swarm_id, state in view.states.items()} == {1: 0, 0: 1, OUTSIDE: 3}


def test_bests_come_highest_first_and_the_excluded_add_voices_but_no_distances():
    far, near, voice = Best(-9.0, (1.0, 0.0)), Best(-4.0, (2.0, 0.0)), Best(30.0, (3.0, 0.0))
    updates = (
        update(0, 0, far),
        update(1, 0, near),
        update(2, OUTSIDE, Best(-1.0, (0.0, 0.0))),
        update(3, OUTSIDE, voice),
    )
    _, bests = CommonView(updates).comparable(updates[0])
    assert bests[0].local == (voice, near, far)
    assert bests[OUTSIDE].local == (voice,)


def test_only_robots_of_the_same_task_and_doors_are_compared():
    door = (Sighting("door", True, 2),)
    updates = (update(0), update(1, epoch=2), update(2, doors=door), update(3, loudest=(5.0, 5.0)))
    view = CommonView(updates)
    assert view.comparable(updates[0])[0].notes == [((0.0, 0.0), None), ((3.0, 0.0), (5.0, 5.0))]
    assert view.comparable(updates[2])[0].notes == [((2.0, 0.0), None)]
    assert view.doors == door
