"""Events of swarms and controllers from what robots decide."""

from __future__ import annotations

import numpy as np
import pytest

from robotteamsim.interface import OUTSIDE, Decision
from robotteamsim.mission.team_watch import TeamWatch


def in_swarms(*swarms: int) -> list[Decision]:
    return [Decision(excluded=swarm == OUTSIDE, swarm=swarm) for swarm in swarms]


@pytest.fixture
def watch() -> TeamWatch:
    """A watch that has seen four robots in two swarms."""
    watch = TeamWatch()
    assert watch.changes(in_swarms(0, 0, 1, 1)) == []
    return watch


def told(watch: TeamWatch, *swarms: int) -> list[str]:
    return [change.detail for change in watch.changes(in_swarms(*swarms))]


def test_nothing_is_told_while_nothing_changes(watch):
    assert told(watch, 0, 0, 1, 1) == []


def test_robot_that_leaves_and_comes_back(watch):
    assert told(watch, 0, OUTSIDE, 1, 1) == ["robot 1 is excluded from swarm 0"]
    assert told(watch, 0, 0, 1, 1) == ["robot 1 is taken into swarm 0"]


def test_swarm_that_all_leave_is_dissolved(watch):
    assert told(watch, OUTSIDE, OUTSIDE, 1, 1) == [
        "robot 0 is excluded from swarm 0",
        "robot 1 is excluded from swarm 0",
        "swarm 0 is dissolved",
    ]
    assert not watch.all_excluded
    told(watch, OUTSIDE, OUTSIDE, OUTSIDE, OUTSIDE)
    assert watch.all_excluded


def test_swarm_that_was_not_there_is_founded_by_those_in_it(watch):
    told(watch, 0, 0, OUTSIDE, OUTSIDE)
    assert told(watch, 0, 0, 2, 2) == ["swarm 2 is founded by robots 2, 3"]
    assert told(watch, 0, 3, 2, 2) == ["robot 1 is excluded from swarm 0", "swarm 3 is founded by robot 1"]


def test_robot_that_is_excluded_from_the_start_counts_as_having_left():
    watch = TeamWatch()
    assert told(watch, 0, OUTSIDE) == ["robot 1 is excluded from swarm 0"]


def test_fault_is_told_once_in_whichever_step_it_comes(watch):
    faulty = [*in_swarms(0, 0, 1), Decision(swarm=1, fault="ValueError: no (x.py:3)")]
    (change,) = watch.changes(faulty)
    assert (change.kind, change.robot_id) == ("controller_failed", 3)
    assert change.detail == "robot 3 is stopped: ValueError: no (x.py:3)"
    assert watch.changes(faulty) == []


def test_base_belongs_to_no_swarm():
    watch = TeamWatch(base=0)
    assert watch.changes(in_swarms(0, 0, 0)) == []
    changes = watch.changes(in_swarms(0, OUTSIDE, OUTSIDE))
    assert [change.kind for change in changes] == ["robot_excluded", "robot_excluded", "swarm_dissolved"]
    assert watch.all_excluded


def test_robot_that_goes_or_comes_is_neither_excluded_nor_taken_in(watch):
    gone = np.array([True, False, True, True])
    assert watch.changes(in_swarms(0, 0, 1, 1), gone) == []
    assert told(watch, 0, 0, 1, 1) == []


def test_swarm_of_robots_that_are_gone_is_dissolved(watch):
    gone = np.array([True, True, False, False])
    assert [change.detail for change in watch.changes(in_swarms(0, 0, 1, 1), gone)] == ["swarm 1 is dissolved"]
    assert not watch.all_excluded


def test_all_are_excluded_when_those_who_are_there_are(watch):
    gone = np.array([True, True, False, False])
    watch.changes(in_swarms(OUTSIDE, OUTSIDE, 0, 0), gone)
    assert watch.all_excluded
