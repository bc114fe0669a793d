"""Infotaxis: entropies by hand, hearing against the voice model, and robots that search."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robotteamsim.control.baselines.infotaxis import (
    Belief,
    Hearing,
    Listening,
    entropy_nats,
    expected_gain_nats,
    parse_listening,
)
from robotteamsim.interface import Task
from robotteamsim.network.messages import Message
from robotteamsim.propagation import VoiceField, VoiceSource
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.floor_plan import Wall
from robotteamsim.scenario.sections import Voice
from robotteamsim.sensing.readings import VoiceReading

NOBODY = np.zeros(4, dtype=bool)


def test_entropy_of_a_uniform_belief_is_the_logarithm_of_its_places():
    assert entropy_nats(np.ones(4)) == pytest.approx(math.log(4.0))
    assert entropy_nats(np.array([1.0, 0.0, 0.0])) == 0.0
    assert entropy_nats(np.zeros(3)) == 0.0


def test_gain_of_a_reading_that_halves_the_places_is_one_bit():
    belief = np.full(4, 0.25)
    assert expected_gain_nats(belief, np.array([1.0, 1.0, 0.0, 0.0]), NOBODY) == pytest.approx(math.log(2.0))
    # A reading that is the same for all places carries no information.
    assert expected_gain_nats(belief, np.full(4, 0.5), NOBODY) == pytest.approx(0.0, abs=1e-12)


def test_gain_counts_finding_the_victim_as_complete_knowledge():
    belief, found = np.full(4, 0.25), np.array([True, False, False, False])
    # 1/4 log 4 for finding them; otherwise the reading carries no information.
    assert expected_gain_nats(belief, np.zeros(4), found) == pytest.approx(0.25 * math.log(4.0))


def test_silence_is_kept_when_voices_are_forgotten_and_counts_once_for_each_place():
    belief = Belief(2)
    belief.add(0, False, np.array([0.5, 0.0]))
    belief.add(0, False, np.array([0.5, 0.0]))
    assert belief.distribution == pytest.approx([1.0 / 3.0, 2.0 / 3.0])
    belief.add(1, True, np.array([1.0, 0.25]))
    assert belief.distribution == pytest.approx([2.0 / 3.0, 1.0 / 3.0])
    belief.forget_voices()
    assert belief.distribution == pytest.approx([1.0 / 3.0, 2.0 / 3.0])


def test_place_that_was_visited_has_no_victim_until_all_are_visited():
    belief = Belief(2)
    belief.visit(0, np.array([True, False]))
    assert belief.distribution == pytest.approx([0.0, 1.0], abs=1e-3)
    belief.visit(1, np.array([False, True]))
    assert belief.distribution == pytest.approx([0.5, 0.5])


def test_voices_that_silence_contradicts_are_forgotten():
    belief = Belief(2)
    belief.add(0, True, np.array([1.0, 0.0]))
    assert belief.distribution == pytest.approx([1.0, 0.0])
    belief.add(1, False, np.array([0.98, 0.0]))
    assert belief.distribution == pytest.approx([0.02 / 1.02, 1.0 / 1.02])


def test_voice_of_an_earlier_epoch_is_ignored(team, hall_scenario):
    scenario = hall_scenario(control={"algorithm": "infotaxis"}, voice=Voice(noise_db=40.0))
    sent = []
    for messages in ([], *([Message(7, -1, Listening(7, epoch, 20, False, True, 20).to_json())] for epoch in (0, 1))):
        hall = team(scenario)
        hall.hear_messages = messages
        sent.append([decision.outbox for _ in range(100) for decision in hall.step()])
    # Only a voice of this epoch changes where the robots go.
    assert sent[0] == sent[1] != sent[2]


def test_belief_starts_again_when_the_whole_floor_is_silent():
    belief = Belief(2)
    belief.add(0, False, np.array([0.9999, 0.9999]))
    assert belief.distribution == pytest.approx([0.5, 0.5])


def test_probability_of_hearing_is_that_of_the_voice_model(hall_scenario):
    hall = hall_scenario().plan
    wall = Wall(name="middle", start=(10.0, 0.2), end=(10.0, 8.0))
    plan = hall.model_copy(update={"walls": (*hall.walls, wall)})
    voice = Voice(noise_db=20.0)
    places = ((2.0, 5.0), (6.0, 5.0), (9.0, 5.0), (18.0, 5.0))
    row = Hearing(Building(plan), voice, places).probabilities(0)
    field = VoiceField(plan, voice)
    for place, probability in zip(places[1:], row[1:], strict=True):
        low_db, high_db = (
            field.level_db(VoiceSource(place, constant_db, exponent), places[0])
            for constant_db, exponent in ((-72.0, 6.0), (-78.0, 5.0))
        )
        expected = min(max((high_db - 20.0) / (high_db - low_db), 0.0), 1.0)
        # The voice map has cells of 0.25 m.
        assert probability == pytest.approx(expected, abs=0.06)
    assert row[0] == 1.0
    assert row[1] > 0.9
    assert row[3] == 0.0


def test_message_survives_the_network_and_nonsense_does_not():
    assert parse_listening(Listening(1, 2, 7, False, True, 9).to_json()) == Listening(1, 2, 7, False, True, 9)
    assert all(parse_listening(text) is None for text in ("", "{}", '{"type": "infotaxis"}', "3"))


def test_robots_search_different_places_and_follow_a_voice(team, hall_scenario):
    hall = team(hall_scenario(control={"algorithm": "infotaxis"}, voice=Voice(noise_db=40.0)))
    hall.task = Task(running=True, epoch=1)
    places = {0: set(), 1: set()}
    for _ in range(900):
        for robot_id, decision in enumerate(hall.step()):
            places[robot_id].add(decision.goal_m)
    assert min(map(len, places.values())) >= 4
    assert len(places[0] & places[1]) < min(map(len, places.values()))
    victim = (10.0, 5.0)
    hall.new_epoch()
    hall.hear = lambda position: VoiceReading(50.0, True, victim, 60.0)
    hall.run(1.2)
    assert all(decision.goal_m == victim for decision in hall.step())
