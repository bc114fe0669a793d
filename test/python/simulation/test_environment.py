from __future__ import annotations

import numpy as np
import pytest

from robotteamsim.network.messages import EVERYBODY, Message
from robotteamsim.scenario.floor_plan import Door
from robotteamsim.simulation import Environment, Simulation

NEAR_ANN, FAR_AWAY = (9.0, 4.5), (1.0, 9.0)
NOTHING_SENT = ((), ())


@pytest.fixture
def environment(hall_scenario) -> Environment:
    return Environment(hall_scenario())


def step(environment, positions=(NEAR_ANN, FAR_AWAY), outboxes=NOTHING_SENT, saved=()):
    return environment.step(np.array(positions), outboxes, saved)


def test_robot_near_a_victim_hears_her_loudest_where_she_is(environment):
    voices, _, _ = step(environment)
    assert voices[0].level_db > 60.0
    assert np.hypot(voices[0].local_best_m[0] - 9.0, voices[0].local_best_m[1] - 4.0) < 0.3


def test_saved_victim_is_not_heard(environment):
    before, _, _ = step(environment)
    changes = environment.voice.changes
    after, _, _ = step(environment, saved=("ann",))
    assert after[0].level_db < before[0].level_db
    assert environment.voice.changes == changes + 1
    silent, _, _ = step(environment, saved=("ann", "bob"))
    assert not silent[0].heard


def test_message_arrives_over_a_link(environment):
    message = Message(0, EVERYBODY, "hello")
    _, network, inboxes = step(environment, outboxes=((message,), ()))
    assert network.adjacency[0, 1]
    assert list(map(tuple, inboxes)) == [(), (message,)]


def test_noise_drowns_voices(environment):
    four_metres_away = ((5.0, 4.0), FAR_AWAY)
    assert step(environment, four_metres_away)[0][0].heard
    environment.set_noise_db(80.0)
    assert not step(environment, four_metres_away)[0][0].heard


def test_moved_victim_calls_from_her_new_place(environment):
    step(environment, saved=("ann", "bob"))
    environment.set_victim("ann", (2.0, 8.5))
    voices, _, _ = step(environment, saved=("bob",))
    assert voices[1].heard
    assert voices[1].level_db > voices[0].level_db


def test_door_is_closed_for_radio_and_voices(hall_scenario):
    scenario = hall_scenario()
    door = Door(name="gate", start=(10.0, 0.2), end=(10.0, 9.8), kind="fireproof")
    plan = scenario.plan.model_copy(update={"doors": (door,)})
    environment = Environment(scenario.model_copy(update={"plan": plan}))
    apart = ((7.0, 4.0), (13.0, 4.0))
    open_voices, open_network, _ = step(environment, apart)
    environment.set_door("gate", True)
    voices, network, _ = step(environment, apart)
    assert open_network.rssi_dbm[0, 1] - network.rssi_dbm[0, 1] == pytest.approx(10.2)
    assert voices[1].level_db <= open_voices[1].level_db
    with pytest.raises(ValueError, match="no_such"):
        environment.set_door("no_such", True)


def test_door_that_slides_is_one_fact_for_world_radio_voices_and_mission(hall_scenario):
    scenario = hall_scenario()
    door = Door(name="gate", start=(10.0, 0.2), end=(10.0, 9.8), kind="fireproof", motion="slide", time_s=1.0)
    simulation = Simulation(scenario.model_copy(update={"plan": scenario.plan.model_copy(update={"doors": (door,)})}))
    apart = np.array([(7.0, 4.0), (13.0, 4.0)])

    def rssi_dbm() -> float:
        _, network, _ = simulation.environment.step(apart, [(), ()], ())
        return float(network.rssi_dbm[0, 1])

    while_open_dbm, told = rssi_dbm(), []
    simulation.set_door("gate", True)
    for index in range(14):
        record = simulation.step()
        told += [event.kind for event in record.events if event.kind.startswith("door")]
        closed = record.doors["gate"].closed
        assert closed == (index >= 9)
        assert simulation.world.door_states().closed() == {"gate": closed}
        assert rssi_dbm() == pytest.approx(while_open_dbm - 10.2 * closed)
        assert ("door" in told) == closed
    assert told == ["door_moves", "door"]
