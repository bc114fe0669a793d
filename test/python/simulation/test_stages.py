from __future__ import annotations

from types import MappingProxyType

import numpy as np
import pytest
from robotteamsim._core.state import State

from robotteamsim.geometry import Pose
from robotteamsim.network.messages import EVERYBODY, Message
from robotteamsim.scenario.floor_plan import Door
from robotteamsim.scenario.sections import Run
from robotteamsim.setup import Setup, resolve
from robotteamsim.simulation import Simulation
from robotteamsim.simulation.stages import HearingStage, NetworkStage
from robotteamsim.world import World

NEAR_ANN, FAR_AWAY = (9.0, 4.5), (1.0, 9.0)


def world_of(setup: Setup) -> World:
    return World(setup.scenario.plan, setup.robots, Run())


@pytest.fixture
def hearing(hall_scenario) -> HearingStage:
    return HearingStage(resolve(hall_scenario()))


def standing_at(positions_m) -> State:
    state = State(len(positions_m))
    for robot_id, (x_m, y_m) in enumerate(positions_m):
        state.place(robot_id, Pose(x_m, y_m, 0.0))
    return state


def heard(hearing, positions=(NEAR_ANN, FAR_AWAY), silent=(), moved=MappingProxyType({})):
    state = standing_at(positions)
    hearing.step(state, moved, silent)
    return state.voices()


def test_robot_near_a_victim_hears_her_loudest_where_she_is(hearing):
    voices = heard(hearing)
    assert voices[0].level_db > 60.0
    assert np.hypot(voices[0].local_best_m[0] - 9.0, voices[0].local_best_m[1] - 4.0) < 0.3


def test_saved_victim_is_not_heard(hearing):
    before, first_map = heard(hearing), hearing.new_map
    after = heard(hearing, silent=("ann",))
    assert after[0].level_db < before[0].level_db
    assert first_map is not None
    assert hearing.new_map is not None
    assert not heard(hearing, silent=("ann", "bob"))[0].heard


def test_voice_map_is_new_only_when_it_has_changed(hearing):
    heard(hearing)
    assert hearing.new_map is not None
    heard(hearing)
    assert hearing.new_map is None


def test_message_arrives_over_a_link(hall_scenario):
    setup = resolve(hall_scenario())
    message = Message(0, EVERYBODY, "hello")
    stage = NetworkStage(setup, world_of(setup))
    network, inboxes = stage.step(standing_at((NEAR_ANN, FAR_AWAY)), ((message,), ()))
    assert network.adjacency[0, 1]
    assert list(map(tuple, inboxes)) == [(), (message,)]


def test_noise_drowns_voices(hearing):
    four_metres_away = ((5.0, 4.0), FAR_AWAY)
    assert heard(hearing, four_metres_away)[0].heard
    hearing.sensor.set_noise_db(80.0)
    assert not heard(hearing, four_metres_away)[0].heard


def test_moved_victim_calls_from_her_new_place(hearing):
    heard(hearing, silent=("ann", "bob"))
    hearing.sensor.set_victim("ann", (2.0, 8.5))
    voices = heard(hearing, silent=("bob",))
    assert voices[1].heard
    assert voices[1].level_db > voices[0].level_db


def test_victim_who_walks_is_heard_where_they_are(hearing):
    before = heard(hearing)
    after = heard(hearing, moved={"ann": (2.0, 8.5)})
    assert after[1].level_db > before[1].level_db


def test_absent_robot_hears_nothing(hearing):
    absent, present = heard(hearing, ((np.nan, np.nan), NEAR_ANN))
    assert (absent.level_db, absent.heard, absent.local_best_level_db) == (0.0, False, 0.0)
    assert np.isnan(absent.local_best_m).all()
    assert present == heard(hearing)[0]


def test_door_is_closed_for_radio_and_voices(hall_scenario):
    scenario = hall_scenario()
    door = Door(name="gate", start=(10.0, 0.2), end=(10.0, 9.8), kind="fireproof")
    plan = scenario.plan.model_copy(update={"doors": (door,)})
    setup = resolve(scenario.model_copy(update={"plan": plan}))
    hearing, network = HearingStage(setup), NetworkStage(setup, world_of(setup))
    apart = ((7.0, 4.0), (13.0, 4.0))

    def rssi_dbm() -> float:
        return float(network.step(standing_at(apart), ((), ()))[0].rssi_dbm[0, 1])

    open_voices, open_dbm = heard(hearing, apart), rssi_dbm()
    hearing.sensor.set_door("gate", True)
    network.radio.set_door("gate", True)
    assert open_dbm - rssi_dbm() == pytest.approx(10.2)
    assert heard(hearing, apart)[1].level_db <= open_voices[1].level_db


def test_door_that_slides_is_one_fact_for_world_radio_voices_and_mission(hall_scenario):
    scenario = hall_scenario()
    door = Door(name="gate", start=(10.0, 0.2), end=(10.0, 9.8), kind="fireproof", motion="slide", time_s=1.0)
    simulation = Simulation(scenario.model_copy(update={"plan": scenario.plan.model_copy(update={"doors": (door,)})}))
    apart = ((7.0, 4.0), (13.0, 4.0))

    def rssi_dbm() -> float:
        network, _ = simulation.network.step(standing_at(apart), [(), ()])
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
