"""Missions of a team that searches: who is saved, in which order, and how the search ends."""

from __future__ import annotations

import itertools

import msgspec
import pytest

from robotteamsim.control.search.team import HeardVoice, SearchUpdate, update_of
from robotteamsim.network import EVERYBODY, Message
from robotteamsim.scenario import load
from robotteamsim.scenario.floor_plan import Wall
from robotteamsim.scenario.sections import Area, Mission, Network, Victim, Voice
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


def _run(hall_scenario, plan=None, noise_db=40.0, control=None, network=None, **mission) -> tuple[Simulation, list]:
    """Run a mission in the hall; return the simulation and the details of its events by kind."""
    fields = {"victims": (ANN, BOB), "areas": (EAST, WEST), "time_limit_s": 300.0} | mission
    sections = {
        "mission": Mission(**fields),
        "control": {"algorithm": "search", **(control or {})},
        "voice": Voice(noise_db=noise_db),
        "network": network or Network(),
    }
    scenario = hall_scenario(**sections)
    if plan is not None:
        scenario = scenario.model_copy(update={"plan": plan})
    simulation = Simulation(scenario)
    events = []
    simulation.mission.start()
    while simulation.mission.status.state != "ended":
        events += simulation.step().events
    assert simulation.controllers.faults == ["", ""]
    return simulation, events


def _end(simulation: Simulation) -> str:
    return simulation.mission.status.end


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


def test_team_saves_all_before_it_explores_the_last_area(hall_scenario):
    simulation, events = _run(hall_scenario)
    kinds = [event.subject for event in events if event.kind in ("victim_saved", "area_explored")]
    assert _end(simulation) == "areas_explored"
    assert set(kinds[:-1]) == {"ann", "bob", "east"}
    assert kinds[-1] == "west"


def test_search_without_areas_ends_when_the_rest_is_not_worth_the_time(hall_scenario):
    simulation, events = _run(hall_scenario, areas=())
    assert _end(simulation) == "search_over"
    assert "worth less than the time" in events[-1].detail
    assert simulation.mission.status.victims == ("saved", "saved")


def test_search_for_nobody_ends_before_the_time_limit(hall_scenario):
    simulation, _ = _run(hall_scenario, victims=())
    assert _end(simulation) == "areas_explored"
    simulation, _ = _run(hall_scenario, victims=(), areas=())
    assert _end(simulation) == "search_over"


def test_noise_above_every_voice_ends_the_search(hall_scenario):
    simulation, _ = _run(hall_scenario, noise_db=79.0, areas=())
    assert _end(simulation) == "search_over"


def test_victim_who_is_enclosed_by_walls_ends_the_search_with_a_reason(hall_scenario):
    hall = hall_scenario().plan
    corners = [(14.0, 3.0), (18.0, 3.0), (18.0, 7.0), (14.0, 7.0), (14.0, 3.0)]
    walls = [Wall(name=f"cell_{i}", start=a, end=b) for i, (a, b) in enumerate(itertools.pairwise(corners))]
    plan = hall.model_copy(update={"walls": (*hall.walls, *walls)})
    locked_up = Victim(name="eve", position=(16.0, 5.0))
    simulation, events = _run(hall_scenario, plan=plan, areas=(), victims=(locked_up,))
    assert _end(simulation) == "search_over"
    assert "cannot be reached" in events[-1].detail


def test_area_behind_walls_ends_the_search_with_its_name(hall_scenario):
    hall = hall_scenario().plan
    wall = Wall(name="wall", start=(12.0, 0.0), end=(12.0, 10.0))
    plan = hall.model_copy(update={"walls": (*hall.walls, wall)})
    simulation, events = _run(hall_scenario, plan=plan, victims=(ANN,))
    assert _end(simulation) == "search_over"
    assert "east cannot be reached" in events[-1].detail


def test_time_limit_leaves_time_for_the_areas(hall_scenario):
    # Nothing is worth so little that the team would stop by itself.
    simulation, _ = _run(hall_scenario, control={"victim_worth_s": 1e9, "expected_victims": 1000.0})
    assert _end(simulation) == "areas_explored"


@pytest.mark.parametrize("assumed_db", [0.0, 75.0])
def test_wrong_assumption_about_the_noise_costs_no_victim(hall_scenario, assumed_db):
    simulation, _ = _run(hall_scenario, control={"assumed_noise_db": assumed_db})
    assert simulation.mission.status.victims == ("saved", "saved")
    controller = simulation.controllers.guards[0].controller
    assert controller.knowledge.noise_db == pytest.approx(40.0, abs=3.0)


def test_robots_that_never_hear_each_other_save_all_and_explore_all(hall_scenario):
    alone = Network(link="distance", max_distance_m=0.01)
    simulation, _ = _run(hall_scenario, network=alone)
    assert simulation.mission.status.victims == ("saved", "saved")
    assert _end(simulation) == "areas_explored"


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


@pytest.mark.slow
def test_garage_team_saves_all_and_explores_all_at_30_db():
    simulation = Simulation(load("garage_sar", ["control.algorithm=search", "voice.noise_db=30", "run.seed=3"]))
    result = simulation.run()
    assert result.end == "areas_explored"
    assert simulation.mission.status.victims == ("saved",) * 4


def test_messages_of_the_garage_team_stay_small():
    simulation = Simulation(load("garage_sar", ["control.algorithm=search", "voice.noise_db=30", "run.seed=3"]))
    sizes = [message.num_bytes for _ in range(1500) for decision in [simulation.step()] for message in _sent(decision)]
    assert max(sizes) < 2000


def _sent(record) -> list[Message]:
    return [message for decision in record.decisions for message in decision.outbox]
