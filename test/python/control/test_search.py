"""Missions of a team that searches: who is saved, in which order, and how the search ends."""

from __future__ import annotations

import itertools

import msgspec
import pytest

from robotteamsim.control.search.areas import RemainingAreas
from robotteamsim.control.search.team import HeardVoice, SearchUpdate, update_of
from robotteamsim.interface import Task
from robotteamsim.network import EVERYBODY, Message
from robotteamsim.scenario import load
from robotteamsim.scenario.floor_plan import Door, Wall
from robotteamsim.scenario.schedule import ScheduledEvent
from robotteamsim.scenario.sections import Area, Mission, Network, PlacedRobot, Victim, Voice
from robotteamsim.simulation import Simulation

ANN, BOB = Victim(name="ann", position=(9.0, 4.0)), Victim(name="bob", position=(17.0, 8.5))
EAST, WEST = Area(name="east", center=(16.0, 5.0)), Area(name="west", center=(5.0, 5.0))
UPDATE = SearchUpdate(
    robot_id=2,
    position=(1.0 / 3.0, 4.0),
    at=21,
    work="voice",
    goal=17,
    voice=HeardVoice((1.5, 2.5), 7.25),
    noise_db=29.9,
    elapsed_s=12.5,
    found=((3.0, 4.0),),
    listened="000305",
)


def test_areas_that_were_passed_over_are_next_again_one_after_the_other(hall_scenario):
    middle = Area(name="middle", center=(10.0, 5.0))
    order = RemainingAreas(hall_scenario(mission=Mission(areas=(EAST, WEST, middle))))
    for area in (EAST, WEST, middle, EAST, WEST):
        order.follow(Task(area_center_m=area.center))
        assert order.next == area
    order.follow(Task())
    assert order.next is None


@pytest.fixture
def run(hall_scenario):
    """Return a function that runs a mission in the hall; it returns the simulation and its events."""

    def run(walls=(), doors=(), noise_db=40.0, control=None, network=None, schedule=(), robots=None, **fields):
        hall = hall_scenario().plan
        sections = {"robots": robots} if robots else {}
        scenario = hall_scenario(
            plan=hall.model_copy(update={"walls": (*hall.walls, *walls), "doors": doors}),
            mission=Mission(**({"victims": (ANN, BOB), "areas": (EAST, WEST), "time_limit_s": 300.0} | fields)),
            control={"algorithm": "search", **(control or {})},
            voice=Voice(noise_db=noise_db),
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
        return simulation, events

    return run


def _controllers(simulation):
    return [guard.controller for guard in simulation.controllers.guards]


def _wall(x_m: float, from_m: float, to_m: float) -> Wall:
    return Wall(name=f"wall_{x_m:g}_{from_m:g}", start=(x_m, from_m), end=(x_m, to_m))


def _box(x_m: float, y_m: float, half_m: float) -> list[Wall]:
    corners = [(x_m + a * half_m, y_m + b * half_m) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1))]
    return [
        Wall(name=f"{half_m:.2f}_{i}", start=start, end=end)
        for i, (start, end) in enumerate(itertools.pairwise(corners))
    ]


def test_update_keeps_every_bit_as_a_message():
    assert update_of(Message(2, EVERYBODY, UPDATE.to_json())) == UPDATE


@pytest.mark.parametrize("payload", ["", "3", "{}", '{"type": "search", "robot_id": 1}', '{"type": 1}', "ä"])
def test_other_messages_are_not_updates(payload):
    assert update_of(Message(2, EVERYBODY, payload)) is None


@pytest.mark.parametrize("noise_db", [-1.0, 1e300])
def test_noise_that_no_voice_can_show_is_not_an_update(noise_db):
    odd = msgspec.structs.replace(UPDATE, noise_db=noise_db)
    assert update_of(Message(2, EVERYBODY, odd.to_json())) is None


def test_update_in_the_name_of_another_robot_is_ignored():
    assert update_of(Message(1, EVERYBODY, UPDATE.to_json())) is None


def test_team_saves_all_before_it_explores_the_last_area(run):
    simulation, events = run()
    kinds = [event.subject for event in events if event.kind in ("victim_saved", "area_explored")]
    assert simulation.mission.status.end == "areas_explored"
    assert set(kinds[:-1]) == {"ann", "bob", "east"}
    assert kinds[-1] == "west"


def test_search_without_areas_ends_when_the_rest_is_not_worth_the_time(run):
    simulation, events = run(areas=())
    assert simulation.mission.status.end == "search_over"
    assert "worth less than the time" in events[-1].detail
    assert simulation.mission.status.victims == ("saved", "saved")


@pytest.mark.parametrize("other_m", [(10.2, 4.0), (9.0, 7.0), (17.0, 8.5)])
def test_each_saved_victim_counts_however_near_another_one_calls(run, other_m):
    simulation, _ = run(victims=(ANN, Victim(name="eve", position=other_m)), areas=(), noise_db=10.0)
    assert simulation.mission.status.victims == ("saved", "saved")
    assert [len(controller.knowledge.found) for controller in _controllers(simulation)] == [2, 2]


def test_search_for_nobody_ends_before_the_time_limit(run):
    simulation, _ = run(victims=())
    assert simulation.mission.status.end == "areas_explored"
    simulation, _ = run(victims=(), areas=())
    assert simulation.mission.status.end == "search_over"


def test_noise_above_every_voice_ends_the_search(run):
    simulation, _ = run(noise_db=79.0, areas=())
    assert simulation.mission.status.end == "search_over"


def test_victim_who_is_enclosed_by_walls_ends_the_search_with_a_reason(run):
    locked_up = Victim(name="eve", position=(16.0, 5.0))
    simulation, events = run(walls=_box(16.0, 5.0, 2.0), areas=(), victims=(locked_up,))
    assert simulation.mission.status.end == "search_over"
    assert "cannot be reached" in events[-1].detail


def test_area_behind_walls_ends_the_search_with_its_name(run):
    simulation, events = run(walls=[_wall(12.0, 0.0, 10.0)], victims=(ANN,))
    assert simulation.mission.status.end == "search_over"
    assert "east cannot be reached" in events[-1].detail


def test_time_limit_leaves_time_for_the_areas(run):
    # Nothing is worth so little that the team would stop by itself.
    simulation, _ = run(control={"victim_worth_s": 1e9, "expected_victims": 1000.0})
    assert simulation.mission.status.end == "areas_explored"


def test_victim_near_a_robot_is_saved_although_time_is_short(run):
    # 13 m to the area at 0.58 m/s, times 1.3, are 29 s: 19 s are spare, and reserve_s is 20. The detour takes 8 s.
    near = Victim(name="ann", position=(2.0, 8.0))
    simulation, _ = run(victims=(near,), areas=(EAST,), time_limit_s=48.0)
    assert (simulation.mission.status.end, simulation.mission.status.victims) == ("areas_explored", ("saved",))
    # Without enough spare time, the area goes first.
    simulation, _ = run(victims=(near,), areas=(EAST,), time_limit_s=32.0)
    assert (simulation.mission.status.end, simulation.mission.status.victims) == ("areas_explored", ("heard",))


@pytest.mark.parametrize("assumed_db", [0.0, 75.0])
def test_wrong_assumption_about_the_noise_costs_no_victim(run, assumed_db):
    simulation, _ = run(control={"assumed_noise_db": assumed_db})
    assert simulation.mission.status.victims == ("saved", "saved")
    controller = simulation.controllers.guards[0].controller
    assert controller.knowledge.noise_db == pytest.approx(40.0, abs=3.0)


def test_robots_that_never_hear_each_other_save_all_and_explore_all(run):
    alone = Network(link="distance", max_distance_m=0.01)
    simulation, _ = run(network=alone)
    assert simulation.mission.status.victims == ("saved", "saved")
    assert simulation.mission.status.end == "areas_explored"


def test_robots_that_start_together_choose_different_goals():
    simulation = Simulation(load("garage_sar", ["control.algorithm=search", "robots.count=8", "voice.noise_db=30"]))
    simulation.mission.start()
    goals: dict[int, int] = {}
    num_iterations = 0
    while num_iterations < 10:
        updates = [update_of(message) for message in _sent(simulation.step())]
        num_iterations += bool(updates)
        goals |= {update.robot_id: update.goal for update in updates if update is not None}
    assert len(set(goals.values())) == 8


def test_network_that_loses_most_messages_costs_no_victim(run):
    # At 10 m the signal is about -60 dBm, so most messages are lost as soon as the robots part.
    lossy = Network(loss="signal", endangered_below_dbm=-30.0, lost_below_dbm=-70.0)
    simulation, _ = run(network=lossy)
    assert simulation.mission.status.victims == ("saved", "saved")
    assert simulation.mission.status.end == "areas_explored"


def test_team_goes_on_without_a_robot_that_fails(run):
    simulation, _ = run(schedule=(ScheduledEvent(at_s=8.0, remove=0),))
    assert simulation.mission.status.victims == ("saved", "saved")
    assert simulation.mission.status.end == "areas_explored"


def test_search_ends_when_all_robots_have_failed(run):
    simulation, _ = run(schedule=tuple(ScheduledEvent(at_s=4.0 + robot_id, remove=robot_id) for robot_id in (0, 1)))
    assert simulation.mission.status.end == "none_left"


def test_team_takes_another_door_when_one_closes(run):
    walls = (_wall(12.0, 0.0, 1.0), _wall(12.0, 2.0, 8.0), _wall(12.0, 9.0, 10.0))
    low = Door(name="low", start=(12.0, 1.0), end=(12.0, 2.0))
    high = Door(name="high", start=(12.0, 8.0), end=(12.0, 9.0))
    closes = ScheduledEvent(at_s=1.0, door="low", closed=True)
    simulation, _ = run(walls=walls, doors=(low, high), schedule=(closes,))
    assert simulation.mission.status.victims == ("saved", "saved")


def test_victim_behind_a_door_is_saved_after_it_opens(run):
    walls = (_wall(12.0, 0.0, 4.0), _wall(12.0, 5.5, 10.0))
    door = Door(name="door", start=(12.0, 4.0), end=(12.0, 5.5), closed=True)
    opens = ScheduledEvent(at_s=6.0, door="door", closed=False)
    simulation, _ = run(walls=walls, doors=(door,), schedule=(opens,), areas=(WEST, EAST))
    assert simulation.mission.status.victims == ("saved", "saved")
    assert simulation.mission.status.end == "areas_explored"


def test_area_behind_a_door_that_closes_for_good_ends_the_search_with_its_name(run):
    walls = (_wall(12.0, 0.0, 4.0), _wall(12.0, 5.5, 10.0))
    door = Door(name="door", start=(12.0, 4.0), end=(12.0, 5.5))
    simulation, events = run(walls=walls, doors=(door,), schedule=(ScheduledEvent(at_s=0.0, door="door", closed=True),))
    assert simulation.mission.status.end == "search_over"
    assert "east cannot be reached" in events[-1].detail


def test_robot_without_a_free_cell_around_it_ends_the_search_with_a_reason(run):
    # Rings of walls that leave no room between them.
    walls = [wall for ring in range(8) for wall in _box(5.0, 5.0, 0.35 + 0.4 * ring)]
    simulation, events = run(walls=walls, robots=(PlacedRobot(start_pose=(5.0, 5.0, 0.0)),), areas=())
    assert simulation.mission.status.end == "search_over"
    assert "no free place can be reached" in events[-1].detail


def test_robot_in_a_box_next_to_free_floor_ends_the_search_with_a_reason(run):
    simulation, events = run(walls=_box(5.0, 5.0, 0.45), robots=(PlacedRobot(start_pose=(5.0, 5.0, 0.0)),), areas=())
    assert simulation.mission.status.end == "search_over"
    assert simulation.mission.status.time_s < 30.0
    assert "no free place can be reached" in events[-1].detail


def test_victim_behind_a_wall_is_reached_on_the_path_around_it(run):
    # The voice comes through the wall: it is loudest where no path leads, and silent on the way around.
    victim = Victim(name="eve", position=(12.6, 1.0))
    simulation, _ = run(walls=(_wall(12.0, 0.0, 8.8),), victims=(victim,), areas=())
    assert simulation.mission.status.victims == ("saved",)


def test_victim_in_the_last_area_or_behind_it_is_saved_before_the_area_ends_the_mission(run):
    # The corridor to the east passes through the last area.
    walls = (
        Wall(name="low", start=(10.0, 3.5), end=(20.0, 3.5)),
        Wall(name="high", start=(10.0, 6.5), end=(20.0, 6.5)),
        _wall(10.0, 0.0, 3.5),
        _wall(10.0, 6.5, 10.0),
    )
    areas = (Area(name="south", center=(5.0, 1.5), radius_m=1.0), Area(name="gate", center=(13.0, 5.0)))
    inside, behind = Victim(name="ida", position=(13.0, 5.0)), Victim(name="eve", position=(18.0, 5.0))
    simulation, _ = run(walls=walls, victims=(inside, behind), areas=areas)
    assert simulation.mission.status.victims == ("saved", "saved")
    assert simulation.mission.status.end == "areas_explored"


@pytest.mark.slow
def test_garage_team_saves_all_and_explores_all_at_30_db():
    simulation = Simulation(load("garage_sar", ["control.algorithm=search", "voice.noise_db=30", "run.seed=3"]))
    result = simulation.run()
    assert result.end == "areas_explored"
    assert simulation.mission.status.victims == ("saved",) * 4


@pytest.mark.slow
def test_messages_of_the_garage_team_stay_small():
    simulation = Simulation(load("garage_sar", ["control.algorithm=search", "voice.noise_db=30", "run.seed=3"]))
    sizes = [message.num_bytes for _ in range(1500) for decision in [simulation.step()] for message in _sent(decision)]
    assert max(sizes) < 2000


def _sent(record) -> list[Message]:
    return [message for decision in record.decisions for message in decision.outbox]
