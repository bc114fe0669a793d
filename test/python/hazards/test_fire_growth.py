"""The heat release rate follows the curve of the fuel wherever it burns: in the open, next to walls, in corners."""

from __future__ import annotations

import math

import numpy as np
import pytest
from burning import HALL, LARGE_HALL, ROOMS, Doors, advance, door_of_kind, everywhere, fire_of

from robotteamsim.errors import ScenarioError
from robotteamsim.hazards import BURNING, BURNT_OUT, NOT_BURNING

ULTRA_FAST = 0.1876
"""kW/s^2, NFPA 204."""
PLACES = {"open": [20.1, 20.1], "wall": [20.1, 0.2], "corner": [0.2, 0.2]}


def kw_at(times_s, fuel, position, plan=LARGE_HALL, **keys) -> list[float]:
    """Return the heat release rate at some times, ascending [kW]."""
    hazards, begin, found = fire_of(plan, {"fuel": [fuel], "ignitions": [{"position": position}], **keys}), 1, []
    for time_s in times_s:
        begin = advance(hazards, time_s - begin + 1, Doors(door=True), begin)
        found.append(hazards.heat_release_kw)
    return found


@pytest.mark.parametrize("cell_m", [0.25, 0.5, 1.0])
@pytest.mark.parametrize("place", PLACES)
def test_heat_release_is_that_of_the_curve_in_the_open_next_to_a_wall_and_in_a_corner(place, cell_m):
    # 0.1876 kW/s^2 * t^2: 4221 kW after 150 s, 16,884 after 300, 37,989 after 450, which burn on 152 of 1600 m^2.
    fuel = everywhere(LARGE_HALL, growth="ultra_fast", load_mj_m2=5000)
    found_kw = kw_at([150, 300, 450], fuel, PLACES[place], cell_m=cell_m)
    assert found_kw == pytest.approx([4221.0, 16_884.0, 37_989.0], rel=0.06 if cell_m < 1.0 else 0.12)


@pytest.mark.parametrize("place", ["wall", "corner"])
def test_heat_release_next_to_walls_is_equal_to_that_in_the_open(place):
    fuel, times_s = everywhere(LARGE_HALL, growth="ultra_fast", load_mj_m2=300), [60, 200, 400, 600]
    assert kw_at(times_s, fuel, PLACES[place]) == pytest.approx(kw_at(times_s, fuel, PLACES["open"]), rel=1e-9)


def test_heat_release_in_a_corridor_is_that_of_the_curve():
    corridor = {"name": "corridor", "bounds": {"max": [60, 2]}}
    fuel = everywhere(corridor, growth="ultra_fast", load_mj_m2=5000)
    # 16,884 kW burn on 67.5 of 120 m^2.
    assert kw_at([150, 300], fuel, [30.1, 1.1], corridor) == pytest.approx([4221.0, 16_884.0], rel=0.06)


def test_all_of_a_room_burns_when_its_curve_reaches_its_peak():
    # 36 m^2 release 9000 kW, which the curve reaches after sqrt(9000 / 0.1876) = 219 s; the last cells then still rise.
    fuel, plan = everywhere(ROOMS, growth="ultra_fast", load_mj_m2=5000), door_of_kind("fireproof")
    before, then, later = kw_at([200, 219, 400], fuel, [0.2, 0.2], plan)
    assert before == pytest.approx(0.1876 * 200**2, rel=0.06)
    assert 0.9 * 9000.0 < then <= 9000.0
    assert later == pytest.approx(9000.0, rel=1e-12)


@pytest.mark.parametrize("place", PLACES)
def test_burning_area_is_that_of_a_disc_or_its_part_of_the_same_area(place):
    """The independent computation: the area within the radius at which a disc, half or quarter has a t^2 / q."""
    fire = {"fuel": [everywhere(LARGE_HALL, growth="ultra_fast", load_mj_m2=5000)], "cell_m": 0.25}
    hazards = fire_of(LARGE_HALL, {**fire, "ignitions": [{"position": PLACES[place]}]})
    advance(hazards, 400)
    x, y = PLACES[place]
    angle = {"open": 2.0, "wall": 1.0, "corner": 0.5}[place] * math.pi
    radius_m = math.sqrt(2.0 * ULTRA_FAST * 400**2 / 250.0 / angle)
    rows, cols = np.nonzero(hazards.field.states != NOT_BURNING)
    distances_m = np.hypot(0.25 * (cols + 0.5) - x, 0.25 * (rows + 0.5) - y)
    assert distances_m.max() == pytest.approx(radius_m, rel=0.06)
    assert len(rows) * 0.25**2 == pytest.approx(0.5 * angle * radius_m**2, rel=0.06)


def test_fire_behind_a_door_has_its_own_curve():
    """The front passes the doorway at its own speed; from then on the second room burns as if it were lit there."""
    fuel = everywhere(ROOMS, growth="ultra_fast", load_mj_m2=5000)
    hazards = fire_of(ROOMS, {"fuel": [fuel], "ignitions": [{"position": [0.2, 3.2]}]})
    doors, begin = Doors(door=False), 1
    while not (hazards.field.states[:, 12:] != NOT_BURNING).any():
        begin = advance(hazards, 1, doors, begin)
    reached_s = begin - 1
    # A disc of 5.3 m radius around (0.2, 3.2), to the last column of cells, has 30 m^2 in the room, and 7500 kW after
    # 200 s. All of the room burns after 219 s. From there to the next cell the front needs up to 32 s.
    assert 200 < reached_s < 219 + 32
    begin = advance(hazards, 400 - reached_s, doors, begin)
    assert hazards.heat_release_kw == pytest.approx(9000.0 + ULTRA_FAST * (400 - reached_s) ** 2, rel=0.06)


def test_growth_may_be_a_number():
    # 0.1 kW/s^2 * 60^2 = 360 kW, but a cell of 0.25 m^2 releases at most 62.5.
    disc = {"name": "sofa", "center": [10.25, 10.25], "radius_m": 0.2, "growth": 0.1}
    position = [10.2, 10.2]
    assert kw_at([10, 20, 60], disc, position, HALL) == pytest.approx([10.0, 40.0, 62.5], rel=1e-12)


SOFA = {"name": "sofa", "center": [10.0, 10.0], "radius_m": 1.5}
CURVE = [[0, 0], [100, 600], [200, 600], [400, 0]]


def test_own_curve_is_released_exactly():
    found_kw = kw_at([50, 100, 150, 250, 300, 399, 450], {**SOFA, "hrr": CURVE}, [10.2, 10.2], HALL)
    assert found_kw == pytest.approx([300.0, 600.0, 600.0, 450.0, 300.0, 3.0, 0.0], abs=1e-9)


def test_time_of_a_curve_counts_from_its_ignition():
    hazards = fire_of(HALL, {"fuel": [{**SOFA, "hrr": CURVE}], "ignitions": [{"at_s": 20, "position": [10.2, 10.2]}]})
    begin = advance(hazards, 20)
    assert len(hazards.ignited) == 1
    assert (hazards.heat_release_kw, hazards.soot_g) == (0.0, 0.0)
    advance(hazards, 50, begin=begin)
    assert hazards.heat_release_kw == pytest.approx(300.0, rel=1e-9)


def test_own_curve_burns_on_the_area_that_its_highest_rate_needs_and_is_then_burnt_out():
    hazards = fire_of(HALL, {"fuel": [{**SOFA, "hrr": CURVE}], "ignitions": [{"position": [10.2, 10.2]}]})
    begin = advance(hazards, 50)
    # 62.5 kW per cell of 0.25 m^2: 300 kW need 5 cells, 600 need 10.
    assert (hazards.field.states == BURNING).sum() == 5
    begin = advance(hazards, 250, begin=begin)
    assert (hazards.field.states == BURNING).sum() == 10
    advance(hazards, 101, begin=begin)
    assert (hazards.field.states == BURNING).sum() == 0
    assert (hazards.field.states == BURNT_OUT).sum() == 10


def test_heat_of_an_own_curve_is_its_integral():
    """Soot is proportional to heat: 0.06 g per 20 kJ; 30,000 + 60,000 + 60,000 kJ are 450 g."""
    hazards = fire_of(HALL, {"fuel": [{**SOFA, "hrr": CURVE}], "ignitions": [{"position": [10.2, 10.2]}]})
    advance(hazards, 500)
    assert hazards.soot_g == pytest.approx(450.0, rel=1e-4)


def test_own_curve_keeps_its_last_value_and_begins_when_fire_arrives():
    near = {"name": "bin", "center": [8.25, 10.25], "radius_m": 0.2, "growth": "ultra_fast"}
    fire = {"fuel": [{**SOFA, "hrr": [[0, 0], [10, 100]]}, near], "ignitions": [{"position": [8.25, 10.25]}]}
    hazards, begin = fire_of(HALL, fire), 1
    while len(hazards.ignited) < 2:
        begin = advance(hazards, 1, begin=begin)
    assert hazards.ignited[1].fuel == "sofa"
    advance(hazards, 60, begin=begin)
    assert hazards.heat_release_kw == pytest.approx(62.5 + 100.0, rel=1e-9)


def test_second_ignition_of_an_own_curve_begins_no_fire():
    fire = {"fuel": [{**SOFA, "hrr": CURVE}], "ignitions": [{"position": [10.2, 10.2]}]}
    hazards, begin = fire_of(HALL, fire), 1
    for seconds in (50, 400):  # it burns; it has burnt out
        begin = advance(hazards, seconds, begin=begin)
        hazards.ignite((9.0, 10.2))
        assert [place.position_m for place in hazards.ignited] == [(10.25, 10.25)]
    advance(hazards, 10, begin=begin)
    assert hazards.heat_release_kw == 0.0
    assert (hazards.field.states == BURNT_OUT).sum() == 10


def test_fire_that_arrives_after_the_end_of_an_own_curve_burns_and_passes_nothing():
    """A shelf lies on both sides of a wall. Its west part burns from 0 to 21 s; a carpet burns up to its east part."""
    shelf = {"name": "shelf", "polygon": [[5, 0], [7, 0], [7, 2], [5, 2]], "hrr": [[0, 4000], [20, 4000], [21, 0]]}
    carpet = {"name": "carpet", "polygon": [[8, 0], [9, 0], [9, 1], [8, 1]], "growth": "ultra_fast"}
    lights = [{"position": [5.2, 0.2]}, {"position": [8.2, 0.2]}]
    hazards = fire_of(door_of_kind("fireproof"), {"fuel": [shelf, carpet], "ignitions": lights})
    advance(hazards, 300, Doors(door=True))
    states = hazards.field.states
    assert (states[:4, 10:12] == BURNT_OUT).all()
    assert (states[:2, 16:18] != NOT_BURNING).all()
    assert (states[:4, 12:14] == NOT_BURNING).all()


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"growth": 0}, r"fire\.fuel\.0\.growth: 0 is below"),
        ({"growth": "quick"}, r"fire\.fuel\.0\.growth: 'quick' is not one of"),
        ({"growth": [1]}, r"fire\.fuel\.0\.growth: \[1\] is neither a class, such as fast, nor a number \[kW/s\^2\]"),
        ({"hrr": []}, r"fire\.fuel\.0\.hrr: "),
        ({"hrr": [[0, 1, 2]]}, r"fire\.fuel\.0\.hrr\.0: \[0, 1, 2\] is not \[t_s, kw\]"),
        ({"hrr": [[0, 0], [5, -1]]}, r"fire\.fuel\.0\.hrr\.1: the rate -1 is not within 0 to 1e\+07 kW"),
        ({"hrr": [[-1, 0]]}, r"fire\.fuel\.0\.hrr\.0: the time -1 is not within 0 to 1e\+06 s"),
        ({"hrr": [[0, float("nan")]]}, r"fire\.fuel\.0\.hrr\.0"),
        ({"hrr": [[0, 0], [9, 1], [9, 2]]}, r"fire\.fuel\.0\.hrr\.2: the time 9 is not after the one before, 9"),
        ({"hrr": [[0, 1]], "growth": "fast"}, r"fire\.fuel\.0\.growth: not allowed together with hrr"),
    ],
)
def test_mistakes_in_curves_are_one_line_with_key_and_value(keys, message):
    with pytest.raises(ScenarioError, match=message) as caught:
        fire_of(HALL, {"fuel": [{**SOFA, **keys}]})
    assert "\n" not in str(caught.value)
