"""Missions with victims who walk or are silent."""

from __future__ import annotations

import numpy as np
import pytest

from robotteamsim.scenario import load
from robotteamsim.scenario.sections import Mission, Victim
from robotteamsim.simulation import Simulation, StepRecord

NEAR = (9.0, 4.0)


def steps(simulation: Simulation, count: int) -> list[StepRecord]:
    return [simulation.step() for _ in range(count)]


def hall(hall_scenario, *victims: Victim, **keys: object) -> Simulation:
    return Simulation(hall_scenario(mission=Mission(victims=victims, **keys)))


def loudest_m(record: StepRecord) -> tuple[float, float]:
    voice_map = record.voice_map
    row, column = np.unravel_index(np.argmax(voice_map.values), voice_map.values.shape)
    (x, y), size_m = voice_map.origin_m, voice_map.resolution_m
    return x + (column + 0.5) * size_m, y + (row + 0.5) * size_m


def test_voice_map_and_record_follow_a_victim_who_walks(hall_scenario):
    ann = Victim(name="ann", position=NEAR, path=((15.0, 4.0),), speed_mps=1.0)
    records = steps(hall(hall_scenario, ann, walk_update_s=2.0), 41)
    fresh = [record for record in records if record.voice_map is not None]
    assert [record.step_index for record in fresh] == [1, 20, 40]
    assert [record.victims[0].position for record in fresh] == [(9.0, 4.0), (11.0, 4.0), (13.0, 4.0)]
    for record in fresh:
        assert np.hypot(*np.subtract(loudest_m(record), record.victims[0].position)) < 0.3


def test_bests_are_kept_while_a_victim_walks(hall_scenario):
    ann = Victim(name="ann", position=NEAR, path=((15.0, 4.0),), speed_mps=1.0)
    assert {record.mission.task.epoch for record in steps(hall(hall_scenario, ann), 50)} == {0}


def test_saved_victim_is_silent_and_walks_no_more(hall_scenario):
    # A robot starts at (3, 4) and saves within 1 m; the victim comes towards it.
    ann = Victim(name="ann", position=(6.0, 4.0), path=((3.0, 4.0), (9.0, 4.0)), speed_mps=1.0)
    records = steps(hall(hall_scenario, ann), 100)
    saved = next(i for i, record in enumerate(records) if record.mission.victims == ("saved",))
    assert len({record.victims[0].position for record in records[saved:]}) == 1
    assert not any(voice.heard for record in records[saved + 1 :] for voice in record.voices)
    last_map = [record.voice_map for record in records[saved:] if record.voice_map is not None][-1]
    assert not last_map.values.any()


def test_silent_victim_is_never_heard_but_saved_by_a_robot_that_comes_near(hall_scenario):
    ann = Victim(name="ann", position=(5.0, 4.0), path=((3.0, 4.0),), speed_mps=3.0, calling=False)
    records = steps(hall(hall_scenario, ann, walk_update_s=0.1), 20)
    assert not any(voice.heard for record in records for voice in record.voices)
    kinds = [event.kind for record in records for event in record.events]
    assert "victim_heard" not in kinds
    assert "victim_saved" in kinds


def test_voice_counts_for_the_nearest_victim_who_calls(hall_scenario):
    silent = Victim(name="ann", position=(8.5, 4.0), calling=False)
    simulation = hall(hall_scenario, silent, Victim(name="bob", position=NEAR))
    heard = [e.subject for record in steps(simulation, 20) for e in record.events if e.kind == "victim_heard"]
    assert heard == ["bob"]


def test_victim_who_is_moved_calls_and_stays_where_they_were_put(hall_scenario):
    ann = Victim(name="ann", position=NEAR, path=((15.0, 4.0),), speed_mps=1.0, calling=False)
    simulation = hall(hall_scenario, ann)
    steps(simulation, 15)
    simulation.set_victim("ann", (12.0, 7.0))
    records = steps(simulation, 40)
    assert {record.victims[0].position for record in records} == {(12.0, 7.0)}
    assert any(voice.heard for voice in records[0].voices)


@pytest.mark.slow
def test_walks_are_repeated_by_the_same_seed():
    overrides = [
        "mission.time_limit_s=30",
        "mission.victims.0.wander={center: [29, 4.5], radius_m: 3}",
        "mission.victims.0.speed_mps=1.2",
    ]

    def run(seed: int) -> tuple[str, list[tuple[float, float]]]:
        simulation = Simulation(load("garage_sar", [*overrides, f"run.seed={seed}"]))
        positions = [record.victims[0].position for record in steps(simulation, 300)]
        return simulation.step().mission.state, positions

    assert run(3) == run(3)
    assert run(3) != run(4)
    assert len(set(run(3)[1])) == 31
