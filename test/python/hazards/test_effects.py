"""What smoke and heat do to sight, people and robots, calculated by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robotteamsim.hazards import Doses, HazardField, HeatStress, walking_speed_share
from robotteamsim.hazards.effects import gas_dose_per_min, heat_dose_per_min
from robotteamsim.scenario.fire import Fire

HERE = [(0.5, 0.5)]


def field(temperature_c: float = 20.0, soot_g_m3: float = 0.0) -> HazardField:
    """Two cells of 1 m: one as given, one clear."""
    temperatures = np.array([[temperature_c, 20.0]], dtype=np.float32)
    soot = np.array([[soot_g_m3, 0.0]], dtype=np.float32)
    return HazardField((0.0, 0.0), 1.0, temperatures, soot, np.zeros((1, 2), dtype=np.uint8), Fire())


def test_visibility_is_jins_c_over_k():
    smoky = field(soot_g_m3=0.1)
    places = np.array([(0.5, 0.5), (1.5, 0.5), (9.0, 9.0)])
    # K = 8.7 m^2/g * 0.1 g/m^3 = 0.87 / m; 3 / 0.87 = 3.448 m; at most 30 m.
    assert smoky.extinction_per_m(places) == pytest.approx([0.87, 0.0, 0.0])
    assert smoky.visibility_m(places) == pytest.approx([3.4483, 30.0, 30.0], rel=1e-4)


def test_carbon_monoxide_follows_soot():
    # 0.04 / 0.06 * 0.3 g/m^3 = 0.2 g/m^3 = 7.14 mmol/m^3, of 41.56 mol of air per cubic metre at 20 degC.
    assert field(soot_g_m3=0.3).co_ppm(np.array(HERE)) == pytest.approx([171.8], rel=1e-3)


def test_dose_by_gas_is_pursers():
    # 2.764e-5 * 1000^1.036 = 0.035446 per minute: 1 after 28.2 min.
    assert 10.0 * gas_dose_per_min(1000.0) == pytest.approx(0.35446, rel=1e-4)


def test_dose_by_heat_is_that_of_clothed_people():
    # 4.1e8 / 100^3.61 = 24.70 min at 100 degC; nothing in comfortable air.
    assert 1.0 / heat_dose_per_min(100.0) == pytest.approx(24.705, rel=1e-3)
    assert heat_dose_per_min(39.0) == 0.0


def test_people_collapse_at_a_dose_of_one_and_die_at_two():
    doses = Doses(Fire())
    hot = field(temperature_c=200.0)  # 4.1e8 / 200^3.61 = 2.023 min = 121.4 s
    changes = {}
    for second in range(1, 400):
        for name, state in doses.expose(["ann", "bob"], [(0.5, 0.5), (1.5, 0.5)], hot, 1.0).items():
            changes[name, state] = second
    assert changes == {("ann", "collapsed"): 122, ("ann", "dead"): 243}
    assert doses.state("bob") == "well"
    assert doses.of("ann").gas == 0.0


def test_people_walk_slower_in_smoke():
    # Frantzich and Nilsson: 0.706 - 0.057 K; at K = 5 / m it is 0.5963 of the speed in clear air.
    assert walking_speed_share(np.array([0.0, 5.0, 100.0])) == pytest.approx([1.0, 0.59632, 0.1], rel=1e-4)


def test_robot_fails_after_its_time_above_its_limit():
    stress = HeatStress(Fire(), 3)
    places = np.array([(0.5, 0.5), (1.5, 0.5), (math.nan, math.nan)])
    hot, cool = field(temperature_c=90.0), field(temperature_c=79.0)
    failed = [stress.expose(places, hot if second <= 20 else cool, 1.0) for second in range(1, 41)]
    assert failed == [[]] * 40  # 20 s were hot
    assert [stress.expose(places, hot, 1.0) for _ in range(10)] == [[]] * 9 + [[0]]


def test_robot_that_left_starts_cool_again():
    stress = HeatStress(Fire(), 1)
    hot, there, gone = field(temperature_c=90.0), np.array(HERE), np.full((1, 2), math.nan)
    assert [stress.expose(there, hot, 10.0) for _ in range(2)] == [[], []]
    stress.expose(gone, hot, 10.0)
    assert [stress.expose(there, hot, 10.0) for _ in range(3)] == [[], [], [0]]
