"""Discoveries delivered to the base, and the mission that waits for them."""

from __future__ import annotations

import msgspec
import pytest
from mission_course import Course

from robotteamsim.interface import Discovery
from robotteamsim.interface.discovery import announcement
from robotteamsim.mission.base_station import BaseStation
from robotteamsim.mission.status import DeliveredDiscoveries
from robotteamsim.network.messages import Message

START_M, EAST_M, WEST_M, ANN_M = (3.0, 1.0), (16.0, 5.0), (5.0, 5.0), (9.0, 4.0)
ANN = Discovery("victim", "ann", 1, ANN_M, 12.5)


def with_base(hall_scenario):
    scenario = hall_scenario()
    return scenario.model_copy(update={"mission": scenario.mission.model_copy(update={"base": 0})})


class BaseCourse(Course):
    """Gives the places of the base and of the other robot, and the payloads that the base receives."""

    def step(self, *places_m, inbox=()):
        return super().step(places_m, inboxes=([Message(1, 0, payload) for payload in inbox], ()))


@pytest.fixture
def course(hall_scenario) -> BaseCourse:
    course = BaseCourse(with_base(hall_scenario))
    course.step(START_M, START_M)
    return course


def test_delivery_of_a_discovery_is_an_event_with_its_delay(course):
    course.step(START_M, ANN_M)
    assert course.step(START_M, ANN_M) == ()
    (found,) = course.mission.status.task.undelivered
    assert found == Discovery("victim", "ann", 1, ANN_M, 0.1)
    (event,) = course.step(START_M, ANN_M, inbox=["nothing", announcement(found)])
    assert (event.kind, event.subject, event.robot_id, event.time_s) == ("discovery_delivered", "ann", 1, 0.3)
    assert event.detail == "ann is delivered to the base, 0.2 s after its discovery by robot 1"
    delivered = course.mission.status.delivered
    assert (delivered.count, delivered.mean_delay_s, delivered.max_delay_s) == pytest.approx((1, 0.2, 0.2))
    assert course.mission.status.task.undelivered == ()


def test_discovery_is_delivered_once(course):
    course.step(START_M, ANN_M)
    payload = announcement(ANN)
    assert [len(course.step(START_M, ANN_M, inbox=[payload, payload])) for _ in range(2)] == [1, 0]


def test_discoveries_of_the_base_are_delivered_at_once(course):
    kinds = [event.kind for event in course.step(ANN_M, START_M)]
    assert kinds == ["victim_saved", "discovery_delivered"]
    assert course.mission.status.delivered == DeliveredDiscoveries(1, 0.0, 0.0)


def test_mission_continues_until_every_discovery_is_delivered(course):
    course.step(START_M, EAST_M)
    course.step(START_M, WEST_M)
    found = course.mission.status.task.undelivered
    assert [(one.kind, one.name) for one in found] == [("area", "east"), ("area", "west")]
    course.step(START_M, WEST_M, inbox=[announcement(found[1])])
    assert course.mission.status.state == "running"
    events = course.step(START_M, WEST_M, inbox=[announcement(found[0])])
    assert [event.kind for event in events] == ["discovery_delivered", "end"]
    assert course.mission.status.end == "areas_explored"


def test_without_a_base_nothing_is_undelivered(hall_scenario):
    course = BaseCourse(hall_scenario())
    course.step(START_M, START_M)
    events = course.step(START_M, ANN_M, inbox=[announcement(ANN)])
    assert [event.kind for event in events] == ["victim_saved"]
    assert course.mission.status.delivered is None
    assert course.mission.status.task.undelivered == ()


def test_discovery_of_a_victim_replaces_the_earlier_one(hall_scenario):
    station = BaseStation(with_base(hall_scenario))
    station.add(ANN)
    again = msgspec.structs.replace(ANN, robot_id=0, position_m=(1.0, 1.0), time_s=20.0)
    station.add(again)
    assert station.undelivered == (again,)
    assert station.deliver((), 21.0) == [(again, True)]  # the base found her itself


def test_a_victim_who_is_found_again_counts_once_unless_they_were_placed_again(hall_scenario):
    station = BaseStation(with_base(hall_scenario))
    again = msgspec.structs.replace(ANN, robot_id=0, time_s=20.0)
    for forgotten, is_first, count in ((False, True, 1), (False, False, 1), (True, True, 2)):
        if forgotten:
            station.forget("victim", "ann")
        station.add(again)
        assert station.deliver((), 21.0) == [(again, is_first)]
        assert station.delivered.count == count
        assert station.undelivered == ()


def test_mean_and_longest_delay_of_three_discoveries():
    delivered = DeliveredDiscoveries().with_delay(1.0).with_delay(4.0).with_delay(1.0)
    assert (delivered.count, delivered.mean_delay_s, delivered.max_delay_s) == pytest.approx((3, 2.0, 4.0))
