"""Events of swarms and controllers from what robots decide."""

from __future__ import annotations

import numpy as np
import pytest

from robotteamsim.interface import OUTSIDE, Decision
from robotteamsim.mission.events import Happening
from robotteamsim.mission.monitors import TeamMonitor

EVERYBODY = np.ones(4, dtype=bool)


def in_swarms(*swarms: int) -> list[Decision]:
    return [Decision(excluded=swarm == OUTSIDE, swarm=swarm) for swarm in swarms]


@pytest.fixture
def monitor() -> TeamMonitor:
    """A monitor that has seen four robots in two swarms."""
    monitor = TeamMonitor()
    assert monitor.changes(in_swarms(0, 0, 1, 1), EVERYBODY) == []
    return monitor


def details(monitor: TeamMonitor, *swarms: int) -> list[str]:
    return [words(change) for change in monitor.changes(in_swarms(*swarms), EVERYBODY[: len(swarms)])]


def words(happening: Happening) -> str:
    return happening.words("robot {}".format)


def test_there_are_no_events_while_nothing_changes(monitor):
    assert details(monitor, 0, 0, 1, 1) == []


def test_robot_that_leaves_and_comes_back(monitor):
    assert details(monitor, 0, OUTSIDE, 1, 1) == ["robot 1 is excluded from swarm 0"]
    assert details(monitor, 0, 0, 1, 1) == ["robot 1 is included in swarm 0"]


def test_swarm_that_all_leave_is_dissolved(monitor):
    assert details(monitor, OUTSIDE, OUTSIDE, 1, 1) == [
        "robot 0 is excluded from swarm 0",
        "robot 1 is excluded from swarm 0",
        "swarm 0 is dissolved",
    ]
    assert not monitor.all_excluded
    details(monitor, OUTSIDE, OUTSIDE, OUTSIDE, OUTSIDE)
    assert monitor.all_excluded


def test_swarm_that_was_not_there_is_founded_by_those_in_it(monitor):
    details(monitor, 0, 0, OUTSIDE, OUTSIDE)
    assert details(monitor, 0, 0, 2, 2) == ["swarm 2 is founded by robots 2, 3"]
    assert details(monitor, 0, 3, 2, 2) == ["swarm 3 is founded by robot 1"]


def test_robot_that_changes_its_swarm_is_included_but_was_never_excluded(monitor):
    assert details(monitor, 0, 1, 1, 1) == ["robot 1 is included in swarm 1"]


def test_robot_that_is_excluded_from_the_start_counts_as_having_left():
    monitor = TeamMonitor()
    assert details(monitor, 0, OUTSIDE) == ["robot 1 is excluded from swarm 0"]


def test_fault_is_one_event_in_any_step(monitor):
    faulty = [*in_swarms(0, 0, 1), Decision(swarm=1, fault="ValueError: no (x.py:3)")]
    (change,) = monitor.changes(faulty, np.ones(len(faulty), dtype=bool))
    assert (change.kind, change.robot_id) == ("controller_failed", 3)
    assert words(change) == "robot 3 is stopped: ValueError: no (x.py:3)"
    assert monitor.changes(faulty, np.ones(len(faulty), dtype=bool)) == []


def test_base_belongs_to_no_swarm():
    monitor = TeamMonitor({0})
    assert monitor.changes(in_swarms(0, 0, 0), EVERYBODY[:3]) == []
    changes = monitor.changes(in_swarms(0, OUTSIDE, OUTSIDE), EVERYBODY[:3])
    assert [change.kind for change in changes] == ["robot_excluded", "robot_excluded", "swarm_dissolved"]
    assert monitor.all_excluded


def test_robot_that_goes_or_comes_is_neither_excluded_nor_taken_in(monitor):
    gone = np.array([True, False, True, True])
    assert monitor.changes(in_swarms(0, 0, 1, 1), gone) == []
    assert details(monitor, 0, 0, 1, 1) == []


def test_swarm_of_robots_that_are_gone_is_dissolved(monitor):
    gone = np.array([True, True, False, False])
    assert [words(change) for change in monitor.changes(in_swarms(0, 0, 1, 1), gone)] == ["swarm 1 is dissolved"]
    assert not monitor.all_excluded


def test_team_is_excluded_when_all_robots_present_are(monitor):
    gone = np.array([True, True, False, False])
    monitor.changes(in_swarms(OUTSIDE, OUTSIDE, 0, 0), gone)
    assert monitor.all_excluded
