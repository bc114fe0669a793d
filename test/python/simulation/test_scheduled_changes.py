"""Missions whose doors, noise and victims change by schedule."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation, StepRecord

CHANGES = (
    "schedule=[{at_s: 2, door: plant_door, closed: true}, {at_s: 3, noise_db: 20}, "
    "{at_s: 4, victim: victim_1, position: [6, 5]}, {at_s: 4, victim: eve, position: [10, 3]}]"
)
CALLS: dict[int, Callable[[Simulation], None]] = {
    20: lambda simulation: simulation.set_door("plant_door", True),
    30: lambda simulation: simulation.set_noise_db(20.0),
    40: lambda simulation: (
        simulation.set_victim("victim_1", (6.0, 5.0)),
        simulation.set_victim("eve", (10.0, 3.0)),
    ),
}
"""The same changes as calls, by the number of steps before them."""


def garage(*overrides: str) -> Simulation:
    return Simulation(load("garage_sar", ["run.seed=7", *overrides]))


def told(record: StepRecord) -> list[tuple[float, str, str]]:
    return [(event.time_s, event.kind, event.detail) for event in record.events]


def test_scheduled_changes_equal_calls_after_the_same_steps():
    scheduled, called = garage(CHANGES), garage()
    kinds = []
    for steps in range(120):
        if steps in CALLS:
            CALLS[steps](called)
        one, other = scheduled.step(), called.step()
        assert told(one) == told(other)
        assert np.array_equal(one.state.true_pose, other.state.true_pose)
        assert (one.voices, one.mission, one.victims, one.noise_db) == (
            other.voices,
            other.mission,
            other.victims,
            other.noise_db,
        )
        assert (one.voice_map is None) == (other.voice_map is None)
        kinds += [(steps, event.kind) for event in one.events if event.kind in ("door", "noise", "victim")]
    assert kinds == [(20, "door"), (30, "noise"), (40, "victim"), (40, "victim")]


def test_change_takes_effect_in_the_first_step_that_begins_at_its_time_or_later():
    simulation = garage("schedule=[{at_s: 0.25, noise_db: 30}, {at_s: 0, noise_db: 20}]")
    assert [simulation.step().noise_db for _ in range(5)] == [20.0, 20.0, 20.0, 30.0, 30.0]


def test_all_events_of_a_step_have_the_time_at_which_it_begins():
    changes = "{at_s: 2, door: plant_door, closed: true}, {at_s: 2, noise_db: 20}, {at_s: 2, remove: 1}"
    simulation = garage(f"schedule=[{changes}, {{at_s: 2, victim: eve, position: [10, 3]}}]")
    records = [simulation.step() for _ in range(21)]
    events = records[-1].events
    assert {"door", "noise", "robot_removed", "victim"} <= {event.kind for event in events}
    assert {event.time_s for event in events} == {2.0} == {records[-1].mission.time_s}
    assert records[-1].sim_time_s == 2.1


def test_scheduled_door_is_one_fact_for_world_and_mission():
    simulation = garage("schedule=[{at_s: 0.1, door: stair_door, closed: false}]")
    first, second = simulation.step(), simulation.step()
    assert (first.doors["stair_door"].closed, second.doors["stair_door"].closed) == (True, False)
    assert [event.detail for event in second.events] == ["door stair_door is opened"]
    assert second.voice_map is not None


def test_saved_victim_who_is_moved_by_the_schedule_can_be_saved_again(hall_scenario):
    start = (3.0, 4.0)
    plain = hall_scenario()
    schedule = [{"at_s": at_s, "victim": "ann", "position": start} for at_s in (0.0, 0.5)]
    fields = {key: getattr(plain, key) for key in type(plain).model_fields}
    simulation = Simulation(type(plain).model_validate(fields | {"schedule": schedule}))
    kinds = [[event.kind for event in simulation.step().events] for _ in range(6)]
    assert kinds[0].count("victim_saved") == kinds[5].count("victim_saved") == 1
    assert "victim" in kinds[5]
