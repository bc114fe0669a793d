"""The fit of radios finds what made the data; their levels are calculated without the package."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.optimize

from robotteamsim.scenario.floor_plan import Bounds, FloorPlan, Wall
from study.wifi.floor import (
    WEAK,
    Readings,
    Walks,
    best_fits,
    columns_of_radios,
    least_squares,
    readings_of,
    wall_field,
    with_materials,
)

PLACE_M, AT_1_M_DBM, EXPONENT, FACTOR, FLOOR_DBM = (4.0, 5.0), -35.0, 2.2, 0.6, -60.0
WALL = Wall(name="a", start=(8.0, 0.0), end=(8.0, 20.0), thickness_m=0.3)  # 3.9 dB in Table 3
PLAN = FloorPlan(name="hall", bounds=Bounds(max=(20.0, 20.0)), walls=(WALL,))


def made(floor_dbm: float) -> Walks:
    """Return walks on both sides of the wall; weaker signals are reported as the floor."""
    x, y = np.meshgrid(np.arange(0.25, 20.0, 0.9), np.arange(0.25, 20.0, 0.9))
    places_m = np.stack([x.ravel(), y.ravel()], axis=1)
    places_m = places_m[np.abs(places_m[:, 0] - 8.0) > 0.2]
    loss_db = 10.0 * EXPONENT * np.log10(np.hypot(*(places_m - PLACE_M).T)) + FACTOR * 3.9 * (places_m[:, 0] > 8.0)
    return Walks(places_m, np.maximum(AT_1_M_DBM - loss_db, floor_dbm)[:, None])


def fits(walks: Walks, floor_dbm: float):
    plans = {"thickness": PLAN, "hull": PLAN, "thick": PLAN, "stud": with_materials(PLAN, 1.0)}
    readings = {weak: readings_of(walks, np.array([0]), floor_dbm, weak) for weak in WEAK}
    candidates = [(float(x), float(y)) for x in range(1, 20, 3) for y in range(2, 20, 3)]
    return best_fits(candidates, walks.places_m, {name: wall_field(plan) for name, plan in plans.items()}, readings)


def test_fit_finds_place_exponent_and_factor_that_made_the_data():
    found = fits(made(-200.0), -200.0)["bounded", "Table 3 times a factor"]
    assert found.place_m == PLACE_M
    assert (found.at_1_m_dbm, found.exponent) == pytest.approx((AT_1_M_DBM, EXPONENT))
    assert found.factor == pytest.approx(FACTOR)
    assert found.squares == pytest.approx(0.0, abs=1e-9)


def test_one_loss_of_all_walls_is_that_of_the_only_wall():
    found = fits(made(-200.0), -200.0)["bounded", "one loss for all walls"]
    assert 1.2 * found.factor == pytest.approx(FACTOR * 3.9)  # 1.2 dB: the stud wall of docs/propagation.md


def test_floor_of_the_receiver_hides_part_of_the_fall_unless_it_is_a_bound():
    found = fits(made(FLOOR_DBM), FLOOR_DBM)
    bounded, measured = (found[weak, "Table 3 times a factor"] for weak in ("bounded", "measured"))
    assert bounded.place_m == PLACE_M
    assert (bounded.exponent, bounded.factor) == pytest.approx((EXPONENT, FACTOR))
    assert measured.exponent < EXPONENT - 0.2 or measured.factor < FACTOR - 0.2


def test_bounded_least_squares_are_those_of_a_general_optimiser():
    draws = np.random.default_rng(3)
    terms = np.stack([np.ones(300), -draws.uniform(0.0, 20.0, 300)], axis=1)
    rssi_dbm = np.maximum(terms @ (-40.0, 2.0) + draws.normal(0.0, 5.0, 300), -65.0)
    at_floor = rssi_dbm <= -65.0
    coefficients, squares = least_squares(terms, Readings(np.arange(300), rssi_dbm, at_floor))

    def errors(x: np.ndarray) -> np.ndarray:
        errors_db = rssi_dbm - terms @ x
        errors_db[at_floor & (errors_db > 0.0)] = 0.0
        return errors_db

    other = scipy.optimize.least_squares(errors, (0.0, 0.0))
    assert 0 < np.count_nonzero(at_floor) < 200
    assert coefficients == pytest.approx(other.x, rel=1e-4)
    assert squares == pytest.approx(2.0 * other.cost)


def test_columns_that_differ_by_little_are_one_radio():
    level_dbm = np.linspace(-40.0, -80.0, 50)
    rssi_dbm = np.stack([level_dbm, level_dbm[::-1], level_dbm + 2.0, np.full(50, np.nan)], axis=1)
    assert [columns.tolist() for columns in columns_of_radios(rssi_dbm)] == [[0, 2], [1], [3]]


def test_names_that_are_not_heard_are_left_out_or_bounds():
    walks = Walks(np.zeros((2, 2)), np.array([[np.nan, -50.0], [-83.0, -84.0]]))
    columns = np.array([0, 1])
    assert readings_of(walks, columns, -84.0, "bounded").rssi_dbm.tolist() == [-50.0, -83.0, -84.0]
    assert readings_of(walks, columns, -84.0, "bounded").at_floor.tolist() == [False, False, True]
    assert readings_of(walks, columns, -84.0, "measured").at_floor.tolist() == [False, False, False]
    assert readings_of(walks, columns, -84.0, "all bounded").at_floor.tolist() == [True, False, False, True]
