"""Missions of a team that searches while something goes wrong: each ends with a stated reason."""

from __future__ import annotations

import itertools

import pytest

from robotteamsim.scenario.floor_plan import Door, Wall
from robotteamsim.scenario.schedule import ScheduledEvent
from robotteamsim.scenario.sections import Area, Mission, Network, PlacedRobot, Victim, Voice
from robotteamsim.simulation import Simulation

ANN, BOB = Victim(name="ann", position=(9.0, 4.0)), Victim(name="bob", position=(17.0, 8.5))
EAST, WEST = Area(name="east", center=(16.0, 5.0)), Area(name="west", center=(5.0, 5.0))


@pytest.fixture
def mission(hall_scenario):
    """Return a function that runs a mission in the hall; it returns the mission, and the detail of its last event."""

    def run(walls=(), doors=(), schedule=(), network=None, robots=None, **fields):
        hall = hall_scenario().plan
        sections = {"robots": robots} if robots else {}
        scenario = hall_scenario(
            plan=hall.model_copy(update={"walls": (*hall.walls, *walls), "doors": doors}),
            mission=Mission(**({"victims": (ANN, BOB), "areas": (EAST, WEST), "time_limit_s": 300.0} | fields)),
            control={"algorithm": "search"},
            voice=Voice(noise_db=40.0),
            network=network or Network(),
            schedule=schedule,
            **sections,
        )
        simulation = Simulation(scenario)
        simulation.mission.start()
        events = []
        while simulation.mission.status.state != "ended":
            events += simulation.step().events
        assert set(simulation.controllers.faults) == {""}
        return simulation.mission, events[-1].detail

    return run


def _wall(x_m: float, from_m: float, to_m: float) -> Wall:
    return Wall(name=f"wall_{x_m:g}_{from_m:g}", start=(x_m, from_m), end=(x_m, to_m))


def _box(x_m: float, y_m: float, half_m: float) -> list[Wall]:
    corners = [(x_m + a * half_m, y_m + b * half_m) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1))]
    return [
        Wall(name=f"{half_m:.2f}_{i}", start=start, end=end)
        for i, (start, end) in enumerate(itertools.pairwise(corners))
    ]


def test_network_that_loses_most_messages_costs_no_victim(mission):
    # At 10 m the signal is about -60 dBm, so most messages are lost as soon as the robots part.
    lossy = Network(loss="signal", endangered_below_dbm=-30.0, lost_below_dbm=-70.0)
    ended, _ = mission(network=lossy)
    assert ended.status.victims == ("saved", "saved")
    assert ended.status.end == "areas_explored"


def test_team_goes_on_without_a_robot_that_fails(mission):
    ended, _ = mission(schedule=(ScheduledEvent(at_s=8.0, remove=0),))
    assert ended.status.victims == ("saved", "saved")
    assert ended.status.end == "areas_explored"


def test_search_ends_when_all_robots_have_failed(mission):
    ended, _ = mission(schedule=tuple(ScheduledEvent(at_s=4.0 + robot_id, remove=robot_id) for robot_id in (0, 1)))
    assert ended.status.end == "none_left"


def test_team_takes_another_door_when_one_closes(mission):
    walls = (_wall(12.0, 0.0, 1.0), _wall(12.0, 2.0, 8.0), _wall(12.0, 9.0, 10.0))
    low = Door(name="low", start=(12.0, 1.0), end=(12.0, 2.0))
    high = Door(name="high", start=(12.0, 8.0), end=(12.0, 9.0))
    closes = ScheduledEvent(at_s=1.0, door="low", closed=True)
    ended, _ = mission(walls=walls, doors=(low, high), schedule=(closes,))
    assert ended.status.victims == ("saved", "saved")


def test_victim_behind_a_door_is_saved_after_it_opens(mission):
    walls = (_wall(12.0, 0.0, 4.0), _wall(12.0, 5.5, 10.0))
    door = Door(name="door", start=(12.0, 4.0), end=(12.0, 5.5), closed=True)
    opens = ScheduledEvent(at_s=6.0, door="door", closed=False)
    ended, _ = mission(walls=walls, doors=(door,), schedule=(opens,), areas=(WEST, EAST))
    assert ended.status.victims == ("saved", "saved")
    assert ended.status.end == "areas_explored"


def test_area_behind_a_door_that_closes_for_good_ends_the_search_with_its_name(mission):
    walls = (_wall(12.0, 0.0, 4.0), _wall(12.0, 5.5, 10.0))
    door = Door(name="door", start=(12.0, 4.0), end=(12.0, 5.5))
    ended, detail = mission(walls=walls, doors=(door,), schedule=(ScheduledEvent(at_s=0.0, door="door", closed=True),))
    assert ended.status.end == "search_over"
    assert "east cannot be reached" in detail


def test_robot_without_a_free_cell_around_it_ends_the_search_with_a_reason(mission):
    # Rings of walls that leave no room between them.
    walls = [wall for ring in range(8) for wall in _box(5.0, 5.0, 0.35 + 0.4 * ring)]
    ended, detail = mission(walls=walls, robots=(PlacedRobot(start_pose=(5.0, 5.0, 0.0)),), areas=())
    assert ended.status.end == "search_over"
    assert "no free place can be reached" in detail


def test_robot_in_a_box_next_to_free_floor_ends_the_search_with_a_reason(mission):
    ended, detail = mission(walls=_box(5.0, 5.0, 0.45), robots=(PlacedRobot(start_pose=(5.0, 5.0, 0.0)),), areas=())
    assert ended.status.end == "search_over"
    assert ended.status.time_s < 30.0
    assert "no free place can be reached" in detail


def test_victim_behind_a_wall_is_reached_on_the_path_around_it(mission):
    # The voice comes through the wall: it is loudest where no path leads, and silent on the way around.
    victim = Victim(name="eve", position=(12.6, 1.0))
    ended, _ = mission(walls=(_wall(12.0, 0.0, 8.8),), victims=(victim,), areas=())
    assert ended.status.victims == ("saved",)


def test_victim_in_the_last_area_or_behind_it_is_saved_before_the_area_ends_the_mission(mission):
    # The corridor to the east passes through the last area.
    walls = (
        Wall(name="low", start=(10.0, 3.5), end=(20.0, 3.5)),
        Wall(name="high", start=(10.0, 6.5), end=(20.0, 6.5)),
        _wall(10.0, 0.0, 3.5),
        _wall(10.0, 6.5, 10.0),
    )
    areas = (Area(name="south", center=(5.0, 1.5), radius_m=1.0), Area(name="gate", center=(13.0, 5.0)))
    inside, behind = Victim(name="ida", position=(13.0, 5.0)), Victim(name="eve", position=(18.0, 5.0))
    ended, _ = mission(walls=walls, victims=(inside, behind), areas=areas)
    assert ended.status.victims == ("saved", "saved")
    assert ended.status.end == "areas_explored"
