from __future__ import annotations

import numpy as np
import pytest
from mission_course import FAR_M, SILENCE, Course

from robotteamsim import _core, rng
from robotteamsim.interface import Task
from robotteamsim.network.messages import Refusal, Traffic
from robotteamsim.scenario import sections
from robotteamsim.scenario.floor_plan import Door
from robotteamsim.sensing.readings import VoiceReading
from robotteamsim.world.doors import DoorState, DoorStates

AREA_EAST_M, AREA_WEST_M = (16.0, 5.0), (5.0, 5.0)
ANN_M, BOB_M = (9.0, 4.0), (12.0, 7.0)


@pytest.fixture
def course(hall_scenario) -> Course:
    return Course(hall_scenario())


def hears(place_m: tuple[float, float], level_db: float = 24.0) -> VoiceReading:
    return VoiceReading(level_db, True, place_m, level_db)


def test_mission_starts_with_its_first_step_and_its_clock_with_the_second(course):
    assert course.kinds() == ["start"]
    assert course.mission.status.state == "running"
    assert course.mission.status.time_s == 0.0
    course.step()
    assert course.mission.status.time_s == 0.1


def test_start_event_lists_areas_victims_and_noise(course):
    (event,) = course.step()
    assert event.detail == "mission starts: 2 areas, 2 victims, 10 dB noise"


def test_mission_without_autostart_waits_for_start(hall_scenario):
    scenario = hall_scenario()
    waiting = scenario.mission.model_copy(update={"autostart": False})
    course = Course(scenario.model_copy(update={"mission": waiting}))
    assert course.kinds(positions=[AREA_EAST_M]) == []
    assert course.mission.status.state == "waiting"
    assert not course.mission.status.task.running
    course.mission.start()
    assert course.mission.status.task.running
    assert course.kinds(positions=[AREA_EAST_M]) == ["start", "area_explored"]


def test_team_does_not_move_before_the_start(course):
    assert course.mission.status.task == Task(running=False, area_center_m=AREA_EAST_M, area_radius_m=2.0)


def test_only_the_target_area_counts_as_explored(course):
    course.step(positions=[AREA_WEST_M])
    assert course.mission.status.explored == (False, False)
    (event,) = course.step(positions=[FAR_M, (16.0, 6.9)])
    assert (event.kind, event.subject, event.robot_id) == ("area_explored", "east", 1)
    assert event.detail == "robot 1 explores east (1 of 2)"
    assert course.mission.status.explored == (True, False)
    assert course.mission.status.target_area == 1
    assert course.mission.status.task.area_center_m == AREA_WEST_M


def test_area_is_explored_at_its_radius_and_not_beyond(course):
    course.step(positions=[(16.0, 7.001)])
    assert course.mission.status.areas_explored == 0
    course.step(positions=[(16.0, 7.0)])
    assert course.mission.status.areas_explored == 1


def test_victim_is_saved_within_the_save_distance_by_the_nearest_robot(course):
    course.step(positions=[(9.0, 5.01)])
    assert course.mission.status.victims == ("waiting", "waiting")
    (event,) = course.step(positions=[(9.0, 4.9), (9.0, 4.5)])
    assert (event.kind, event.subject, event.robot_id) == ("victim_saved", "ann", 1)
    assert event.detail == "robot 1 saves ann (1 of 2)"
    assert course.mission.status.victims == ("saved", "waiting")


def test_saved_victim_is_saved_once(course):
    course.step(positions=[ANN_M])
    assert course.kinds(positions=[ANN_M]) == []


def test_heard_victim_is_the_one_who_is_loudest_at_the_loudest_place(hall_scenario):
    course = Course(hall_scenario(), {(10.4, 5.0): "bob", ANN_M: "ann"}.get)  # ann is nearer to both places
    events = course.step(voices=[SILENCE, hears((10.4, 5.0))])
    assert (events[1].kind, events[1].subject, events[1].robot_id) == ("victim_heard", "bob", 1)
    assert events[1].detail == "robot 1 hears bob at 24.0 dB"
    course.step(voices=[hears(ANN_M)])
    assert course.mission.status.victims == ("heard", "heard")


def test_voice_after_the_last_victim_was_saved_is_nobody(hall_scenario):
    course = Course(hall_scenario(), lambda place_m: None)
    course.step(positions=[ANN_M, BOB_M])
    assert course.kinds(voices=[hears(ANN_M)]) == []


def test_epoch_grows_when_a_victim_falls_silent_and_when_the_target_area_changes(course):
    course.step()
    assert course.mission.status.task.epoch == 0
    course.step(voices=[hears(ANN_M)])
    assert course.mission.status.task.epoch == 0
    course.step(positions=[ANN_M])
    assert course.mission.status.task.epoch == 1
    course.step(positions=[AREA_EAST_M])
    assert course.mission.status.task.epoch == 2


def test_doors_noise_and_victims_are_noted_and_raise_the_epoch(course):
    course.step()
    course.mission.set_noise_db(20.0)
    course.mission.set_victim("eve", (4.0, 8.0))
    assert course.mission.status.task.epoch == 2
    assert course.mission.status.victims == ("waiting",) * 3
    assert course.mission.noise_db == 20.0
    assert [event.detail for event in course.step()] == [
        "background noise is 20 dB",
        "victim eve calls at (4.0, 8.0)",
    ]


def test_victim_who_moves_is_saved_where_they_are_and_the_epoch_stays(course):
    course.step()
    assert course.kinds(positions=[(4.0, 8.0)], moved={"ann": (4.0, 8.0)}) == ["victim_saved"]
    assert course.mission.victims[0].position == (4.0, 8.0)
    assert course.kinds(moved={"ann": (2.0, 2.0)}) == []
    assert course.mission.victims[0].position == (4.0, 8.0)
    assert course.mission.status.task.epoch == 1


def test_leaf_of_a_door_is_reported_when_it_starts_is_blocked_and_stops(hall_scenario):
    scenario = hall_scenario()
    gate = Door(name="gate", start=(10.0, 0.2), end=(10.0, 1.2), motion="swing")
    plan = scenario.plan.model_copy(update={"doors": (gate,)})
    course = Course(scenario.model_copy(update={"plan": plan}))
    course.step()
    told, epochs = [], []
    states = (
        DoorState(False, 1.0),
        DoorState(False, 0.9, "closes"),
        DoorState(False, 0.8, "closes"),
        DoorState(False, 0.42, "held"),
        DoorState(True, 0.0),
        DoorState(False, 0.1, "opens"),
        DoorState(False, 1.0),
    )
    for version, state in enumerate(states):
        told += [event.detail for event in course.step(doors=DoorStates({"gate": state}, version))]
        epochs.append(course.mission.status.task.epoch)
    assert told == [
        "door gate closes, 90% open",
        "door gate is blocked, 42% open",
        "door gate is closed",
        "door gate is opened",
        "door gate stops, 100% open",
    ]
    # Only what fades voices changes the task.
    assert epochs == [0, 0, 0, 0, 1, 2, 2]


def test_moved_victim_waits_again_and_can_be_saved_again(course):
    course.step(positions=[ANN_M])
    course.mission.set_victim("ann", (2.0, 8.0))
    assert course.mission.status.victims == ("waiting", "waiting")
    assert course.kinds(positions=[(2.0, 8.0)]) == ["victim", "victim_saved"]


def test_endangered_links_are_counted_each_time_they_become_endangered(course):
    (_, event) = course.step(endangered=[(0, 1)])
    assert (event.subject, event.detail) == ("0-1", "link 0-1 is endangered at -81.3 dBm")
    assert course.kinds(endangered=[(0, 1)]) == []
    course.step()
    assert course.kinds(endangered=[(0, 1)]) == ["link_endangered"]
    assert course.mission.status.endangered_links == 2


def test_link_that_is_lost_at_once_counts_as_endangered_and_its_return_does_not(course):
    course.step()
    (event,) = course.step(lost=[(0, 1)])
    assert (event.kind, event.detail) == ("link_endangered", "link 0-1 is lost at -97.0 dBm")
    assert course.kinds(lost=[(0, 1)]) == course.kinds(endangered=[(0, 1)]) == course.kinds() == []
    assert course.kinds(endangered=[(0, 1)]) == ["link_endangered"]
    assert course.kinds(lost=[(0, 1)]) == []
    assert course.mission.status.endangered_links == 2


def test_link_that_never_was_good_is_not_endangered_when_it_is_lost(course):
    assert course.kinds(lost=[(0, 1)]) == ["start"]
    assert course.mission.status.endangered_links == 0


def test_exclusion_and_inclusion_are_events(course):
    course.step()
    (event,) = course.step(excluded=[1])
    assert (event.kind, event.robot_id) == ("robot_excluded", 1)
    (event,) = course.step()
    assert (event.kind, event.robot_id) == ("robot_included", 1)


def test_mission_ends_when_all_areas_are_explored(course):
    course.step(positions=[AREA_EAST_M])
    events = course.step(positions=[AREA_WEST_M, ANN_M])
    assert [event.kind for event in events] == ["victim_saved", "area_explored", "end"]
    assert events[-1].detail == "mission ends: all areas are explored; 2/2 areas, 1/2 victims"
    status = course.mission.status
    assert (status.state, status.end, status.target_area) == ("ended", "areas_explored", -1)
    assert not status.task.running


def test_mission_ends_at_the_time_limit(hall_scenario):
    scenario = hall_scenario(mission=sections.Mission(time_limit_s=0.3))
    course = Course(scenario)
    for _ in range(3):
        course.step()
    assert course.mission.status.state == "running"
    assert course.kinds() == ["end"]
    assert (course.mission.status.end, course.mission.status.time_s) == ("time_limit", 0.3)


def test_mission_ends_when_all_robots_are_excluded(course):
    course.step(excluded=[0])
    assert course.mission.status.state == "running"
    assert course.kinds(excluded=[0, 1]) == ["robot_excluded", "swarm_dissolved", "end"]
    assert course.mission.status.end == "all_excluded"


def test_exploring_the_last_area_in_the_last_moment_is_success(hall_scenario):
    area = sections.Area(name="only", center=AREA_EAST_M)
    course = Course(hall_scenario(mission=sections.Mission(areas=(area,), time_limit_s=0.1)))
    course.step()
    course.step(positions=[AREA_EAST_M], excluded=[0, 1])
    assert course.mission.status.end == "areas_explored"


def test_abort_ends_the_mission_once(course):
    course.step()
    course.mission.abort()
    course.mission.abort()
    assert [(event.kind, event.time_s) for event in course.step()] == [("end", 0.1)]
    assert (course.mission.status.end, course.mission.status.time_s) == ("aborted", 0.1)


def test_time_does_not_advance_while_paused(course):
    course.step()
    course.step()
    course.mission.pause()
    assert not course.mission.status.task.running
    assert course.kinds(positions=[ANN_M]) == ["pause"]
    time_s = course.mission.status.time_s  # the robots still obeyed the task of the step before the pause
    course.step()
    course.step()
    assert course.mission.status.time_s == time_s
    assert course.mission.status.victims_saved == 0
    course.mission.resume()
    assert course.kinds() == ["resume"]
    assert course.mission.status.time_s == time_s
    course.step()
    assert course.mission.status.time_s == pytest.approx(time_s + 0.1)


def test_nothing_happens_after_the_end(course):
    course.step()
    course.mission.abort()
    course.step()
    status = course.mission.status
    course.mission.start()
    course.mission.pause()
    course.mission.resume()
    assert course.kinds(positions=[AREA_EAST_M, ANN_M], excluded=[0, 1], endangered=[(0, 1)]) == []
    assert course.mission.status == status


def test_two_missions_with_equal_inputs_have_equal_events(hall_scenario):
    def events() -> list:
        course = Course(hall_scenario())
        walk = [FAR_M, ANN_M, BOB_M, AREA_EAST_M, AREA_WEST_M]
        return [event for place in walk for event in course.step(positions=[place])]

    assert events() == events()


def test_message_that_is_too_large_is_reported_once_with_robot_size_and_limit(course):
    course.step()
    refused = Traffic(refused=(Refusal(1, 70_000, 65_507),))
    told = [event for _ in range(3) for event in course.step(traffic=refused)]
    assert [(e.kind, e.robot_id, e.detail) for e in told] == [
        ("message_too_large", 1, "robot 1 cannot send 70000 bytes, the limit is 65507")
    ]


def test_places_are_reached_by_the_nearest_robot_within_reach_the_first_of_equals():
    generator = rng.stream(5, "places")
    for _ in range(200):
        points_m, places_m = generator.integers(0, 12, (7, 2)) * 0.5, generator.integers(0, 12, (9, 2)) * 0.5
        reaches_m = generator.integers(0, 4, 9) * 0.5
        apart_m = np.hypot(*(places_m[:, None] - points_m[None]).transpose(2, 0, 1))
        expected = [(place, int(np.argmin(row))) for place, row in enumerate(apart_m) if row.min() <= reaches_m[place]]
        places = _core.base.Places(list(map(tuple, places_m.tolist())), reaches_m.tolist())
        assert places.reached(points_m) == expected
        assert places.reached(np.asfortranarray(points_m)) == expected


def test_places_of_wrong_type_or_length_are_rejected():
    with pytest.raises(TypeError, match="incompatible function arguments"):
        _core.base.Places([("here", "there")], [0.0])
    with pytest.raises(TypeError, match="incompatible function arguments"):
        _core.base.Places([(0.0, 0.0)], [0.0]).reached(np.zeros((1, 3)))
    with pytest.raises(ValueError, match="one reach per place"):
        _core.base.Places([(0.0, 0.0)], [0.0, 0.0])


def test_robots_that_go_and_come_are_events(course):
    course.step()
    gone = course.step(present=(True, False))
    assert [(event.kind, event.robot_id, event.detail) for event in gone] == [
        ("robot_removed", 1, "robot 1 is removed")
    ]
    assert course.step(present=(True, False)) == ()
    assert [event.detail for event in course.step()] == ["robot 1 is spawned"]


def test_robot_that_is_not_there_explores_and_saves_nothing(course):
    course.step()
    course.step(positions=[(np.nan, np.nan), FAR_M], present=(False, True))
    assert course.mission.status.areas_explored == 0
    course.step(positions=[(np.nan, np.nan), AREA_EAST_M], present=(False, True))
    assert course.mission.status.areas_explored == 1


def test_mission_ends_when_no_robot_is_left(course):
    course.step()
    course.step(present=(True, False))
    assert course.mission.status.state == "running"
    events = course.step(positions=[(np.nan, np.nan)] * 2, present=(False, False))
    assert course.mission.status.end == "none_left"
    assert events[-1].detail.startswith("mission ends: no robots left; ")


def test_robots_in_reserve_at_the_start_cause_no_event(hall_scenario):
    loaded = hall_scenario()
    robots = tuple(robot.model_copy(update={"present": i == 0}) for i, robot in enumerate(loaded.robots))
    course = Course(loaded.model_copy(update={"robots": robots}))
    assert course.kinds(present=(True, False)) == ["start"]
    assert course.kinds() == ["robot_spawned"]
