"""The fire: t-squared growth, spread by chance, doors, burn-out, and what is rejected."""

from __future__ import annotations

import math

import numpy as np
import pytest
from burning import HALL, ROOMS, STEP_NS, Doors, advance, door_of_kind, everywhere, fire_of

from robotteamsim.errors import ScenarioError
from robotteamsim.hazards import BURNING, BURNT_OUT, NOT_BURNING, Hazards
from robotteamsim.scenario.schedule import ScheduledEvent
from robotteamsim.simulation.stages import ScheduleStage

FAST = 0.0469
"""kW/s^2, NFPA 204."""
CENTRE = {"ignitions": [{"position": [10.2, 10.2]}]}
LEFT = {"ignitions": [{"position": [3.2, 3.2]}]}


def one_cell(**fuel: object) -> Hazards:
    """One cell of 0.25 m^2 with fuel."""
    here = {"name": "bin", "center": [10.25, 10.25], "radius_m": 0.2, "growth": "fast", **fuel}
    return fire_of(HALL, {"fuel": [here], **CENTRE})


def carpet(seed: int, growth: str = "ultra_fast", **fuel: object) -> Hazards:
    return fire_of(HALL, {"fuel": [everywhere(growth=growth, load_mj_m2=5000, **fuel)], **CENTRE}, seed)


def test_heat_release_rate_of_one_cell_grows_with_the_square_of_time_up_to_its_peak():
    hazards = one_cell(peak_kw_m2=250.0, load_mj_m2=100.0)
    for second in range(1, 60):
        advance(hazards, 1, begin=second)
        assert hazards.heat_release_kw == pytest.approx(min(FAST * second**2, 250.0 * 0.25), rel=1e-12)


def test_cell_burns_out_when_its_fuel_is_spent():
    # 0.25 m^2 hold 250 kJ; growth * t^3 / 3 reaches that after 25.2 s.
    hazards = one_cell(load_mj_m2=1.0)
    end_s = (3 * 250.0 / FAST) ** (1 / 3)
    following = advance(hazards, math.floor(end_s))
    assert (hazards.field.states == BURNING).sum() == 1
    advance(hazards, 1, begin=following)
    assert (hazards.field.states == BURNING).sum() == 0
    assert (hazards.field.states == BURNT_OUT).sum() == 1
    assert hazards.heat_release_kw == 0.0


@pytest.mark.slow
def test_fire_on_uniform_fuel_grows_with_the_square_of_time():
    # From 4 times on in which one cell reaches its peak, 18 s; before, the fire is smaller than a few cells.
    times_s = np.array([80, 120, 160, 200])
    fires = [carpet(seed) for seed in range(40)]
    means = []
    begin = 1
    for time_s in times_s:
        for hazards in fires:
            following = advance(hazards, time_s - begin + 1, begin=begin)
        begin = following
        means.append(np.mean([hazards.heat_release_kw for hazards in fires]))
    assert np.array(means) == pytest.approx(0.1876 * times_s**2, rel=0.1)


@pytest.mark.slow
def test_fire_spreads_equally_in_all_directions():
    # Radii of the burnt area in eight directions, over many fires.
    areas = np.zeros(8)
    rows, cols = np.mgrid[0:40, 0:40]
    direction = np.round(np.arctan2(rows - 20, cols - 20) / (math.pi / 4)).astype(int) % 8
    for seed in range(150):
        hazards = carpet(seed)
        advance(hazards, 260)
        burnt = hazards.field.states != NOT_BURNING
        burnt[20, 20] = False  # belongs to no direction
        areas += np.bincount(direction[burnt], minlength=8)
    # Cells on the border between two directions count for one of them; a disc shows how many.
    disc = np.hypot(rows - 20, cols - 20) <= math.sqrt(areas.sum() / 150 / math.pi)
    disc[20, 20] = False
    radii = np.sqrt(areas / np.bincount(direction[disc], minlength=8))
    assert radii / radii.mean() == pytest.approx(np.ones(8), abs=0.05)


def test_same_seed_gives_the_same_fire_and_another_seed_another():
    first, again, other = carpet(3), carpet(3), carpet(4)
    for hazards in (first, again, other):
        advance(hazards, 200)
    assert np.array_equal(first.field.states, again.field.states)
    assert first.field.temperatures_c.tobytes() == again.field.temperatures_c.tobytes()
    assert not np.array_equal(first.field.states, other.field.states)


@pytest.mark.parametrize("proof", [{"kind": "fireproof"}, {"key": True}])
def test_nothing_passes_a_closed_fireproof_door(proof):
    plan = door_of_kind(proof["kind"]) if "kind" in proof else ROOMS
    doors = {"fireproof": ["door"]} if "key" in proof else {}
    fire = {"fuel": [everywhere(ROOMS, growth="ultra_fast", load_mj_m2=200)], **LEFT, **doors}
    hazards = fire_of(plan, fire)
    advance(hazards, 2500, Doors(door=True))
    left, right = slice(0, 12), slice(12, 24)
    assert (hazards.field.states[:, left] == BURNT_OUT).all()
    assert (hazards.field.states[:, right] == NOT_BURNING).all()
    assert hazards.field.soot_g_m3[:, left].min() > 0.0
    assert not hazards.field.soot_g_m3[:, right].any()
    assert (hazards.field.temperatures_c[:, right] == 20.0).all()
    assert hazards.burnt_doors() == ()


def test_fire_passes_an_open_door_also_a_fireproof_one():
    fire = {"fuel": [everywhere(ROOMS, growth="ultra_fast", load_mj_m2=5000)], **LEFT}
    hazards = fire_of(door_of_kind("fireproof"), fire)
    advance(hazards, 600, Doors(door=False))
    assert (hazards.field.states[:, 12:] == BURNING).any()


def test_normal_door_burns_through_after_its_time_next_to_flames():
    fire = {"fuel": [everywhere(ROOMS, growth="ultra_fast", load_mj_m2=5000)], **LEFT, "heat": {"door_endures_s": 60.0}}
    hazards, doors, begin, beside_s = fire_of(ROOMS, fire), Doors(door=True), 1, 0
    while not hazards.burnt_doors():
        assert (hazards.field.states[:, 12:] == NOT_BURNING).all()
        begin = advance(hazards, 1, doors, begin)
        # The leaf, from y = 2.4 to 3.6 m, is between columns 11 and 12 of rows 5, 6 (centres at 2.75 and 3.25 m).
        beside_s += bool((hazards.field.states[5:7, 11] == BURNING).any())
    assert hazards.burnt_doors() == ("door",)
    assert beside_s == 60
    advance(hazards, 300, doors, begin)
    assert (hazards.field.states[:, 12:] == BURNING).any()


def test_fire_does_not_jump_over_ground_without_fuel_that_is_wider_than_its_reach():
    strips = [everywhere(growth="ultra_fast", load_mj_m2=5000)]
    strips[0]["polygon"] = [[0, 0], [9, 0], [9, 20], [0, 20]]
    strips.append({**strips[0], "name": "beyond", "polygon": [[11, 0], [20, 0], [20, 20], [11, 20]]})
    hazards = fire_of(HALL, {"fuel": strips, "ignitions": [{"position": [8, 10]}]})
    advance(hazards, 600)
    assert (hazards.field.states[:, :18] == BURNING).sum() > 300
    assert (hazards.field.states[:, 18:] == NOT_BURNING).all()


def test_room_ends_at_its_walls_and_doors():
    fire = {"fuel": [{"name": "office", "room": [2, 2], "growth": "ultra_fast", "load_mj_m2": 5000}], **LEFT}
    hazards = fire_of({**ROOMS, "doors": [{**ROOMS["doors"][0], "closed": False}]}, fire)
    advance(hazards, 1200, Doors(door=False))
    assert (hazards.field.states[:, :12] == BURNING).all()
    assert (hazards.field.states[:, 12:] == NOT_BURNING).all()


def test_ignition_by_list_by_schedule_and_by_call_are_the_same():
    fuel = {"fuel": [everywhere()]}
    listed = fire_of(HALL, {**fuel, "ignitions": [{"at_s": 5, "position": [10.2, 10.2]}]})
    scheduled, called = fire_of(HALL, fuel), fire_of(HALL, fuel)
    advance(listed, 60)
    schedule = ScheduleStage([ScheduledEvent(at_s=5.0, ignite=(10.2, 10.2))], scheduled)
    for step in range(1, 61):
        schedule.step(step * STEP_NS)
        advance(scheduled, 1, begin=step)
    advance(called, 4)
    called.ignite((10.2, 10.2))
    advance(called, 56, begin=5)
    assert listed.heat_release_kw == scheduled.heat_release_kw == called.heat_release_kw > 0.0


def test_nothing_changes_before_the_first_ignition():
    hazards = fire_of(HALL, {"fuel": [everywhere()]})
    before = hazards.field
    assert not hazards.step(STEP_NS, Doors())  # the first step has no update
    assert hazards.step(2 * STEP_NS, Doors())
    assert hazards.field is before


@pytest.mark.parametrize(
    ("fire", "message"),
    [
        ({"fuel": [{"name": "a", "center": [30, 5], "radius_m": 1}]}, r"fire\.fuel\.0\.center: \[30, 5\] lies outside"),
        ({"fuel": [{"name": "a", "room": [6, 1]}]}, r"fire\.fuel\.0\.room: \[6, 1\] lies in wall 'south'"),
        (
            {"fuel": [everywhere(ROOMS)], "ignitions": [{"position": [6, 1]}]},
            r"ignitions\.0\.position: \[6, 1\] lies in wall",
        ),
        ({"ignitions": [{"position": [3, 3]}]}, r"ignitions\.0\.position: \[3, 3\]: there is no fuel"),
        ({"fuel": [{"name": "a", "center": [3, 3]}]}, r"fire\.fuel\.0\.radius_m: missing"),
        ({"fuel": [{"name": "a"}]}, r"fire\.fuel\.0: expected exactly one of room, polygon, center; found none"),
        ({"fireproof": ["gate"]}, r"fire\.fireproof\.0: there is no door 'gate'; known: door"),
        ({"fds": "out", "ignitions": [{"position": [3, 3]}]}, r"fire\.ignitions: not allowed together with fds"),
    ],
)
def test_mistakes_are_one_line_with_key_and_value(fire, message):
    with pytest.raises(ScenarioError, match=message) as caught:
        fire_of(ROOMS, fire)
    assert "\n" not in str(caught.value)
