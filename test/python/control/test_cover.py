"""Robots that cover the floor and announce victims to the base."""

from __future__ import annotations

import json

import numpy as np
import pytest

from robotteamsim.control.cover.controller import CoverController
from robotteamsim.control.cover.floor_cover import CoverUpdate, parse_cover_update
from robotteamsim.errors import ScenarioError
from robotteamsim.interface import Discovery, Observation, Task
from robotteamsim.network import EVERYBODY, Message
from robotteamsim.scenario import load
from robotteamsim.scenario.sections import Mission, PlacedRobot, Victim, Voice
from robotteamsim.simulation import Simulation, StepRecord

UPDATE = CoverUpdate(2, (1.0 / 3.0, 4.0), (7.0, 8.0), "00ff", (Discovery("victim", "", 4, (1.5, 2.5), 12.3),))


ANN = Victim(name="ann", position=(9.0, 4.0))


def _simulation(hall_scenario, victims=(ANN,), noise_db=40.0, **control) -> Simulation:
    poses = [(1.0, 1.0, 0.0), (2.0, 1.0, 0.0), (1.0, 2.0, 0.0)]
    scenario = hall_scenario(
        robots=tuple(PlacedRobot(start_pose=pose) for pose in poses),
        mission=Mission(base=0, victims=victims, time_limit_s=90.0),
        control={"algorithm": "cover", **control},
        voice=Voice(noise_db=noise_db),
    )
    return Simulation(scenario)


def _controllers(simulation: Simulation) -> list[CoverController]:
    return [guard.controller for guard in simulation.controllers.guards]


def test_update_keeps_every_bit_as_a_message():
    assert parse_cover_update(UPDATE.to_json()) == UPDATE


@pytest.mark.parametrize("payload", ["", "3", "{}", "[]", '{"type": "cover", "robot_id": 1}', '{"type": 1}', "ä"])
def test_other_messages_are_not_updates(payload):
    assert parse_cover_update(payload) is None


def test_each_saved_victim_is_announced_although_another_one_calls_nearby(hall_scenario):
    eve = Victim(name="eve", position=(11.0, 4.0))
    simulation = _simulation(hall_scenario, victims=(ANN, eve), noise_db=10.0)
    for _ in range(400):
        record = simulation.step()
    assert record.mission.victims == ("saved", "saved")
    assert all(len(controller.found) == 2 for controller in _controllers(simulation))


def test_team_covers_the_hall_and_announces_the_victim_to_the_base(hall_scenario):
    simulation = _simulation(hall_scenario)
    heard = []
    for _ in range(900):
        record = simulation.step()
        heard += [parse_cover_update(m.payload) for m in record.inboxes[0]]
    base, *others = _controllers(simulation)
    assert record.mission.victims == ("saved",)
    assert base.found == heard[-1].discoveries
    assert len(base.found) == 1
    assert np.hypot(*np.subtract(base.found[0].position_m, (9.0, 4.0))) < 0.5
    assert all(controller.found == base.found for controller in others)
    # All that is left is what nobody can see into.
    assert all(controller.covered_share > 0.95 for controller in _controllers(simulation))


def test_base_stays_where_it_starts(hall_scenario):
    simulation = _simulation(hall_scenario)
    for _ in range(100):
        record = simulation.step()
    places = [(reading.ground_truth.x_m, reading.ground_truth.y_m) for reading in record.readings]
    assert places[0] == pytest.approx((1.0, 1.0), abs=1e-9)
    assert np.hypot(*np.subtract(places[1], (2.0, 1.0))) > 1.0


def test_message_of_another_floor_or_malformed_message_is_ignored(hall_scenario):
    simulation = _simulation(hall_scenario)
    record = simulation.step()
    controller: CoverController = _controllers(simulation)[1]
    before = controller.covered_share
    observation = _observation(record)
    payloads = [UPDATE.to_json(), "nonsense", json.dumps({"type": "cover", "robot_id": 2})]
    controller.step(observation, [Message(2, EVERYBODY, text) for text in payloads], Task(running=False))
    assert controller.covered_share == before
    assert controller.found == ()


def test_partition_splits_the_team_and_heals(hall_scenario):
    simulation = _simulation(hall_scenario)
    sent = []
    for _ in range(5):
        record = simulation.step()
        sent += [parse_cover_update(message.payload) for message in record.inboxes[1]]
    first, second = _controllers(simulation)[1:]
    victim = Discovery("victim", "", 0, (15.0, 5.0), 1.0)
    update = CoverUpdate(0, (1.0, 1.0), None, sent[-1].covered, (victim,))
    observation = _observation(record)
    first.step(observation, [Message(0, EVERYBODY, update.to_json())], record.mission.task)
    assert (len(first.found), len(second.found)) == (1, 0)
    for _ in range(12):  # the next updates
        simulation.step()
    assert len(second.found) == len(_controllers(simulation)[0].found) == 1


def test_base_that_does_not_exist_is_rejected():
    with pytest.raises(ScenarioError, match=r"mission.base: there is no robot 9; expected 0 to 8"):
        load("office_manet", ["mission.base=9"])


def test_office_team_hears_each_other_in_the_beginning():
    simulation = Simulation(load("office_manet"))
    for _ in range(15):
        network = simulation.step().network
    assert network.fiedler_value > 0.0
    assert network.adjacency[0].sum() == 8
    assert network.traffic.refused == ()


def _observation(record: StepRecord) -> Observation:
    return Observation(1, record.sim_time_ns, record.readings[1], record.voices[1])
