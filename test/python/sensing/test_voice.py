"""What robots hear."""

import math

import numpy as np
import pytest
from robotteamsim._core.state import State

from robotteamsim.geometry import Pose
from robotteamsim.scenario.floor_plan import Bounds, Door, FloorPlan, Wall
from robotteamsim.scenario.sections import Victim, Voice
from robotteamsim.sensing.readings import VoiceReading
from robotteamsim.sensing.voice import VoiceSensor

_ANN = Victim(name="ann", position=(3.0, 3.0))
_BOB = Victim(name="bob", position=(15.0, 6.0))


@pytest.fixture
def plan() -> FloorPlan:
    return FloorPlan(
        name="hall",
        bounds=Bounds(max=(20.0, 10.0)),
        walls=(Wall(name="middle", start=(10.0, 0.0), end=(10.0, 8.0)),),
        doors=(Door(name="gate", start=(10.0, 8.0), end=(10.0, 10.0)),),
    )


def heard_at(sensor: VoiceSensor, position_m: tuple[float, float]) -> VoiceReading:
    """Return what a robot hears at a position in `map` [m]."""
    state = State(1)
    state.place(0, Pose(*position_m, 0.0))
    sensor.hear(state)
    return state.voice_of(0)


def test_the_call_of_a_victim_is_drawn_from_the_ranges_and_depends_on_seed_and_name_alone(plan):
    alone = VoiceSensor(plan, Voice(), [_BOB], seed=4).map().values
    second = VoiceSensor(plan, Voice(), [_ANN, _BOB], seed=4)
    second.set_silenced(["ann"])
    assert np.array_equal(second.map().values, alone)
    assert not np.array_equal(VoiceSensor(plan, Voice(), [_BOB], seed=5).map().values, alone)
    at_one_metre = VoiceSensor(plan, Voice(map_resolution_m=0.1), [_BOB], seed=4).map().value_at(15.95, 6.05)
    assert 72.0 < at_one_metre < 80.0


def test_reading_is_the_own_cell_and_the_loudest_around(plan):
    sensor = VoiceSensor(plan, Voice(local_best_radius_m=1.5), [_ANN], seed=1)
    voice_map = sensor.map()
    reading = heard_at(sensor, (6.1, 4.2))
    assert reading.heard
    assert reading.level_db == voice_map.value_at(6.1, 4.2)
    assert reading.local_best_level_db == voice_map.value_at(*reading.local_best_m)
    assert math.dist(reading.local_best_m, (6.1, 4.2)) <= 1.5
    expected = max(
        (voice_map.values[cell], -cell[0], -cell[1])
        for cell in np.ndindex(voice_map.values.shape)
        if math.dist(voice_map.cell_center(*cell), (6.1, 4.2)) <= 1.5
    )
    assert (reading.local_best_level_db, reading.local_best_m) == (
        expected[0],
        voice_map.cell_center(-expected[1], -expected[2]),
    )


def test_nothing_is_heard_where_all_is_below_the_noise(plan):
    sensor = VoiceSensor(plan, Voice(noise_db=80.0), [_ANN], seed=1)
    reading = heard_at(sensor, (18.0, 2.0))
    assert (reading.level_db, reading.heard, reading.local_best_m) == (0.0, False, (18.0, 2.0))
    assert reading.local_best_level_db == 0.0


def test_beyond_the_map_nothing_is_heard(plan):
    assert not heard_at(VoiceSensor(plan, Voice(), [_ANN], seed=1), (40.0, 3.0)).heard


def test_walls_give_no_voice(plan):
    assert VoiceSensor(plan, Voice(), [_ANN], seed=1).map().value_at(10.0, 3.0) == 0.0


def test_silenced_victim_leaves_the_map_and_calls_again_when_set(plan):
    sensor = VoiceSensor(plan, Voice(), [_ANN], seed=1)
    before = sensor.map().values
    sensor.set_silenced(["ann"])
    assert not sensor.map().values.any()
    sensor.set_victim("ann", (3.0, 3.0))
    assert np.array_equal(sensor.map().values, before)


def test_changes_count_what_changes_the_map_and_nothing_else(plan):
    sensor = VoiceSensor(plan, Voice(), [_ANN, _BOB], seed=1)
    start = sensor.version
    sensor.set_silenced([])
    sensor.set_noise_db(10.0)
    sensor.set_door("gate", False)
    sensor.set_victim("ann", (3.0, 3.0))
    assert sensor.version == start
    sensor.set_silenced(["bob", "ann"])
    sensor.set_silenced(["ann", "bob"])
    assert sensor.version == start + 1
    sensor.set_noise_db(20.0)
    sensor.set_door("gate", True)
    sensor.set_victim("cleo", (5.0, 5.0))
    assert sensor.version == start + 4


def test_map_is_kept_until_a_change(plan):
    sensor = VoiceSensor(plan, Voice(), [_ANN], seed=1)
    kept = sensor.map()
    heard_at(sensor, (3.0, 4.0))
    assert sensor.map() is kept
    sensor.set_door("gate", True)
    assert sensor.map() is not kept


def test_moved_victim_calls_from_the_new_place_as_loud_as_before(plan):
    sensor = VoiceSensor(plan, Voice(), [_ANN], seed=1)
    level_db = heard_at(sensor, (3.125, 3.125)).level_db
    sensor.set_victim("ann", (5.0, 5.0))
    assert heard_at(sensor, (5.125, 5.125)).level_db == pytest.approx(level_db)


def test_wrong_names_and_values_are_rejected(plan):
    sensor = VoiceSensor(plan, Voice(), [_ANN, _BOB], seed=1)
    with pytest.raises(ValueError, match=r"^there is no victim 'eve', only ann, bob$"):
        sensor.set_silenced(["eve"])
    with pytest.raises(ValueError, match=r"^unknown door 'back'; known: gate$"):
        sensor.set_door("back", True)
    with pytest.raises(ValueError, match=r"^position_m must be finite, got \(inf, 1\)$"):
        heard_at(sensor, (math.inf, 1.0))
    with pytest.raises(ValueError, match=r"^position of victim 'ann' must be finite, got \(1.0, inf\)$"):
        sensor.set_victim("ann", (1.0, math.inf))
    with pytest.raises(ValueError, match="noise_db must be finite"):
        sensor.set_noise_db(math.nan)
