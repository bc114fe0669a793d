"""Areas that come later because no robot knows a path, and areas that robots choose themselves."""

from __future__ import annotations

import json

import pytest
from mission_course import FAR_M, Course

from robotteamsim.interface import EVERYBODY, Decision, Message
from robotteamsim.interface.closed_area import closed_area_in

EAST_M, WEST_M = (16.0, 5.0), (5.0, 5.0)


@pytest.fixture
def course(hall_scenario) -> Course:
    course = Course(hall_scenario())
    course.step()
    return course


def report(robot_id: int, closed_m: tuple[float, float] | None = None, fault: str = "") -> Decision:
    content = {"robot_id": robot_id} | ({} if closed_m is None else {"closed_area": closed_m})
    return Decision(outbox=(Message(robot_id, EVERYBODY, json.dumps(content)),), fault=fault)


def test_area_that_no_robot_can_reach_comes_after_the_others(course):
    both_report = [report(0, EAST_M), report(1, EAST_M)]
    (event,) = course.step(decisions=both_report)
    assert (event.kind, event.subject) == ("area_passed_over", "east")
    assert event.detail == "east is passed over: no robot knows a path to it"
    assert course.mission.status.task.area_center_m == WEST_M
    assert (course.mission.status.target_area, course.mission.status.task.epoch) == (1, 1)
    assert course.kinds() == []  # the last reports are about another area
    assert course.kinds(positions=[WEST_M]) == ["area_explored"]
    assert course.mission.status.explored == (False, True)
    assert course.mission.status.task.area_center_m == EAST_M
    assert course.kinds(decisions=both_report) == []  # no other one is left
    assert course.kinds(positions=[FAR_M, EAST_M]) == ["area_explored", "end"]
    assert course.mission.status.end == "areas_explored"


def test_mission_whose_areas_are_all_closed_keeps_the_last_one(course):
    course.step(decisions=[report(0, EAST_M), report(1, EAST_M)])
    for _ in range(3):
        assert course.kinds(decisions=[report(0, WEST_M), report(1, WEST_M)]) == []
    assert course.mission.status.target_area == 1


@pytest.mark.parametrize(
    ("first", "second", "passed"),
    [
        ({}, {"decisions": [report(0, EAST_M), Decision()]}, False),
        ({}, {"decisions": [report(0, EAST_M), report(1)]}, False),
        ({}, {"decisions": [report(0, EAST_M), report(1, WEST_M)]}, False),
        ({"decisions": [Decision(), report(1, EAST_M)]}, {"decisions": [report(0, EAST_M), report(1)]}, False),
        ({"decisions": [Decision(), report(1, EAST_M)]}, {"decisions": [report(0, EAST_M), Decision()]}, True),
        ({}, {"decisions": [report(0, EAST_M), Decision()], "present": (True, False)}, True),
        ({}, {"decisions": [report(0, EAST_M), Decision(fault="stopped")]}, True),
    ],
    ids=["silent", "reaches it", "another area", "taken back", "said before", "absent", "stopped"],
)
def test_all_who_are_there_must_report_the_area(course, first, second, passed):
    course.step(**first)
    assert ("area_passed_over" in course.kinds(**second)) == passed


@pytest.mark.parametrize("payload", ["", '{"closed_area"', '{"closed_area": [1]}', '{"closed_area": [1, "a"]}'])
def test_other_messages_report_no_area(payload):
    assert closed_area_in(payload) is None


def test_areas_that_robots_choose_count_in_any_order(hall_scenario):
    scenario = hall_scenario()
    chosen = scenario.mission.model_copy(update={"area_order": "nearest"})
    course = Course(scenario.model_copy(update={"mission": chosen}))
    course.step()
    assert (course.mission.status.target_area, course.mission.status.task.explored_by) == (-1, (-1, -1))
    assert (course.mission.status.task.area_center_m, course.mission.status.task.area_radius_m) == (None, 0.0)
    assert course.kinds(decisions=[report(0, EAST_M), report(1, EAST_M)]) == []  # each robot has its own areas
    assert course.kinds(positions=[FAR_M, WEST_M]) == ["area_explored"]
    task = course.mission.status.task
    # The robots learn of it over the network, so it changes nothing for them.
    assert (task.explored_by, task.epoch, task.area_center_m) == ((-1, 1), 0, None)
    assert course.mission.status.explored == (False, True)
    assert course.kinds(positions=[FAR_M, WEST_M]) == []
    assert course.kinds(positions=[EAST_M]) == ["area_explored", "end"]
    assert (course.mission.status.task.explored_by, course.mission.status.end) == ((0, 1), "areas_explored")
