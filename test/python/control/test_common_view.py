"""What robots that heard the same reports conclude alike."""

from __future__ import annotations

from robotteamsim.control.rdpso.common_view import CommonView, common_view
from robotteamsim.control.rdpso.update import Best, RdpsoUpdate, parse_update
from robotteamsim.interface import OUTSIDE
from robotteamsim.swarm import SwarmState


def report(robot_id: int, swarm_id: int = 0, local_best: Best | None = None, epoch: int = 1, **changes) -> RdpsoUpdate:
    fields = {
        "iteration": 3,
        "position": (float(robot_id), 0.0),
        "loudest": None,
        "known_best": None,
        "swarm": SwarmState(robot_id, 0),
    }
    return RdpsoUpdate(robot_id=robot_id, swarm_id=swarm_id, local_best=local_best, epoch=epoch, **(fields | changes))


def test_robots_that_parsed_the_same_messages_share_one_view():
    payloads = [report(i).to_json() for i in range(3)]
    assert common_view(tuple(map(parse_update, payloads))) is common_view(tuple(map(parse_update, payloads)))
    assert common_view((report(0), report(1))) is not common_view((report(0), report(1, epoch=2)))


def test_each_swarm_has_its_members_and_the_memory_of_the_lowest():
    view = CommonView((report(0, 1), report(1, 0, Best(-2.0, (0.0, 0.0))), report(2, 1), report(3, OUTSIDE)))
    assert view.values == {1: {0: float("-inf"), 2: float("-inf")}, 0: {1: -2.0}, OUTSIDE: {3: float("-inf")}}
    assert view.positions[1] == {0: (0.0, 0.0), 2: (2.0, 0.0)}
    assert {swarm_id: state.search_counter for swarm_id, state in view.states.items()} == {1: 0, 0: 1, OUTSIDE: 3}


def test_bests_come_highest_first_and_the_excluded_add_voices_but_no_distances():
    far, near, voice = Best(-9.0, (1.0, 0.0)), Best(-4.0, (2.0, 0.0)), Best(30.0, (3.0, 0.0))
    reports = (
        report(0, 0, far),
        report(1, 0, near),
        report(2, OUTSIDE, Best(-1.0, (0.0, 0.0))),
        report(3, OUTSIDE, voice),
    )
    _, bests = CommonView(reports).comparable(reports[0])
    assert bests[0].local == (voice, near, far)
    assert bests[OUTSIDE].local == (voice,)


def test_only_robots_of_the_same_task_and_doors_are_compared():
    door = (("door", True, 2),)
    reports = (report(0), report(1, epoch=2), report(2, doors=door), report(3, loudest=(5.0, 5.0)))
    view = CommonView(reports)
    assert view.comparable(reports[0])[0].notes == [((0.0, 0.0), None), ((3.0, 0.0), (5.0, 5.0))]
    assert view.comparable(reports[2])[0].notes == [((2.0, 0.0), None)]
    assert view.doors == door
