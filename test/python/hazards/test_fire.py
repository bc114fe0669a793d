"""The fire: t-squared growth, spread by chance, doors, burn-out, and what is rejected."""

from __future__ import annotations

import math

import numpy as np
import pytest
from burning import HALL, LARGE_HALL, ROOMS, STEP_NS, Doors, advance, door_of_kind, everywhere, fire_of

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


def carpet(seed: int, **keys: object) -> Hazards:
    return fire_of(HALL, {"fuel": [everywhere(growth="ultra_fast", load_mj_m2=5000)], **CENTRE, **keys}, seed)


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
@pytest.mark.parametrize("cell_m", [0.25, 0.5, 1.0])
@pytest.mark.parametrize(("growth", "kw_s2", "peak_kw_m2"), [("ultra_fast", 0.1876, 250.0), ("fast", 0.0469, 500.0)])
def test_fire_on_uniform_fuel_grows_with_the_square_of_time_on_any_grid(cell_m, growth, kw_s2, peak_kw_m2):
    fuel = everywhere(LARGE_HALL, growth=growth, peak_kw_m2=peak_kw_m2, load_mj_m2=5000)
    fire = {"fuel": [fuel], "ignitions": [{"position": [20.1, 20.1]}], "cell_m": cell_m}
    hazards, begin = fire_of(LARGE_HALL, fire), 1
    for megawatts in (12, 25, 50):
        end_s = round(math.sqrt(megawatts * 1e3 / kw_s2))
        begin = advance(hazards, end_s - begin + 1, begin=begin)
        assert hazards.heat_release_kw == pytest.approx(kw_s2 * end_s**2, rel=0.05)


@pytest.mark.slow
def test_mean_of_many_fires_grows_with_the_square_of_time():
    fires = [carpet(seed, growth_sd=0.2, cell_m=1.0) for seed in range(400)]
    for hazards in fires:
        advance(hazards, 253)
    shares = np.array([hazards.heat_release_kw for hazards in fires]) / (0.1876 * 253**2)
    # The standard error of the mean is 0.01.
    assert shares.mean() == pytest.approx(1.0, abs=0.05)
    assert shares.std(ddof=1) == pytest.approx(0.2, abs=0.03)


def test_heat_release_does_not_depend_on_the_interval_of_the_updates():
    fuel = {"fuel": [everywhere(growth="ultra_fast")], **CENTRE}
    often, seldom = fire_of(HALL, fuel), fire_of(HALL, {**fuel, "update_s": 5.0})
    for hazards in (often, seldom):
        advance(hazards, 150)
    assert often.heat_release_kw == pytest.approx(seldom.heat_release_kw, rel=1e-9)


@pytest.mark.slow
def test_fire_spreads_equally_in_all_directions():
    fuel = everywhere(growth="ultra_fast", load_mj_m2=5000)
    hazards = fire_of(HALL, {"fuel": [fuel], "ignitions": [{"position": [9.95, 9.95]}], "cell_m": 0.1})
    advance(hazards, 300)
    rows, cols = np.nonzero(hazards.field.states != NOT_BURNING)
    x_m, y_m = 0.1 * (cols - 99), 0.1 * (rows - 99)
    radii = [np.max(x_m * math.cos(angle) + y_m * math.sin(angle)) for angle in np.arange(0.0, 2 * math.pi, 0.1)]
    assert radii == pytest.approx(np.full(len(radii), np.mean(radii)), rel=0.02)
    # 300 s at the speed of the front, sqrt(a / (pi q)), and half a cell: flames begin at the edge of a cell.
    assert np.mean(radii) == pytest.approx(300 * math.sqrt(0.1876 / (math.pi * 250.0)) + 0.05, rel=0.02)


def test_same_seed_gives_the_same_fire_and_another_seed_another():
    first, again, other = (carpet(seed, growth_sd=0.2) for seed in (3, 3, 4))
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


@pytest.mark.parametrize(
    ("kind", "named", "beside_until_s"), [("normal", [], 120), ("fireproof", [], 120), ("normal", ["door"], 300)]
)
def test_door_with_a_fire_resistance_endures_it_and_one_named_fireproof_for_ever(kind, named, beside_until_s):
    rated = {"kind": kind, "fire_resistance_min": 2.0}
    plan = {**ROOMS, "doors": [{**door, **rated} for door in ROOMS["doors"]]}
    fuel = [everywhere(ROOMS, growth="ultra_fast", load_mj_m2=5000)]
    hazards, doors, begin, beside_s = fire_of(plan, {"fuel": fuel, **LEFT, "fireproof": named}), Doors(door=True), 1, 0
    while not hazards.burnt_doors() and beside_s < 300:
        if kind == "fireproof":
            assert not hazards.field.soot_g_m3[:, 12:].any()
        begin = advance(hazards, 1, doors, begin)
        beside_s += bool((hazards.field.states[5:7, 11] == BURNING).any())
    assert beside_s == beside_until_s


def test_fire_does_not_pass_a_door_that_closes_before_it_is_there_nor_wait_behind_one():
    fuel = [everywhere(ROOMS, growth="ultra_fast", load_mj_m2=5000)]
    hazards, doors = fire_of(door_of_kind("fireproof"), {"fuel": fuel, **LEFT, "cell_m": 0.25}), Doors(door=False)
    # The front moves at 15.5 mm/s: it needs 181 s to the door.
    begin = advance(hazards, 170, doors)
    doors.set("door", True)
    begin = advance(hazards, 500, doors, begin)
    assert (hazards.field.states[:, 24:] == NOT_BURNING).all()
    doors.set("door", False)
    begin = advance(hazards, 5, doors, begin)
    assert (hazards.field.states[:, 24:] == NOT_BURNING).all()
    advance(hazards, 100, doors, begin)
    rows, cols = np.nonzero(hazards.field.states[:, 24:] == BURNING)
    reached_m = 0.25 * np.max(np.hypot(cols + 0.5, np.maximum(0.25 * np.abs(rows - 11.5) - 0.6, 0.0) / 0.25))
    # 0.1876 * 105^2 / 250 = 8.27 m^2, which a half disc and the width of the leaf, 1.2 m, have at a radius of 1.94 m.
    assert reached_m == pytest.approx(1.94, abs=0.3)


@pytest.mark.parametrize("cell_m", [0.25, 0.5, 1.0])
@pytest.mark.parametrize(("gap_m", "crosses"), [(1.0, True), (2.0, False)])
def test_fire_crosses_ground_without_fuel_of_a_width_in_metres(cell_m, gap_m, crosses):
    strips = [everywhere(growth="ultra_fast", load_mj_m2=5000), everywhere(growth="ultra_fast", load_mj_m2=5000)]
    strips[0]["polygon"] = [[0, 0], [9, 0], [9, 20], [0, 20]]
    begin_m = 9 + gap_m
    strips[1] |= {"name": "beyond", "polygon": [[begin_m, 0], [20, 0], [20, 20], [begin_m, 20]]}
    hazards = fire_of(HALL, {"fuel": strips, "ignitions": [{"position": [8.1, 10.1]}], "cell_m": cell_m})
    advance(hazards, 600)
    edge = round(9 / cell_m)
    assert (hazards.field.states[:, :edge] == BURNING).sum() * cell_m**2 > 75
    assert (hazards.field.states[:, edge:] == BURNING).any() == crosses


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
    schedule = ScheduleStage([ScheduledEvent(at_s=5.0, ignite=(10.2, 10.2))])
    for step in range(1, 61):
        schedule.step(step * STEP_NS, scheduled)
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
