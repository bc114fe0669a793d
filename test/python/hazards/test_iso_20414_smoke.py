"""Tests 18 and 19 of ISO 20414: people in smoke or heat that is the same everywhere, from results of FDS [iso20414]."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fds_run import write_run

from robotteamsim.scenario.loading import from_mapping
from robotteamsim.simulation import Simulation

EXTINCTION_M2_G = 8.7


def mission(
    folder: Path, size_m: tuple[float, float], person: dict[str, Any], soot_g_m3: float, temperature_c: float
) -> Simulation:
    """A person in a room without walls, with an exit at its eastern end."""
    constant = {"TEMPERATURE": ("temp", "C", temperature_c), "SOOT DENSITY": ("rho_soot", "kg/m3", soot_g_m3 / 1e3)}
    slices = [
        (quantity, label, unit, lambda x, y, time_s, value=value: np.full(x.shape, value))
        for quantity, (label, unit, value) in constant.items()
    ]
    data = {
        "name": "smoke",
        "plan": {"name": "room", "bounds": {"max": list(size_m)}},
        "robots": {"count": 1, "start": [0.5, 0.5, 0.0]},
        "command_centre": 0,
        "firefighters": {"count": 1, "start": [0.5, 1.5, 0.0], "searches": False, "block_c": 2000.0},
        "control": {"algorithm": "cover"},
        "fire": {"fds": write_run(folder, slices, size_m), "heat": {"block_c": 2000.0, "robot_limit_c": 2000.0}},
        "mission": {
            "saved_by": "firefighter",
            "victims": [{"name": "ann", "flees": True, "calling": False, **person}],
            "exits": [{"name": "exit", "center": [size_m[0] - 1.0, size_m[1] / 2.0]}],
            "rescue": {"safe_m": 0.1},
            "walk_update_s": 0.1,
            "time_limit_s": 300.0,
        },
    }
    simulation = Simulation(from_mapping(data, "smoke.yaml"))
    simulation.mission.start()
    return simulation


def time_of(simulation: Simulation, kind: str) -> float:
    """Return when an event occurs, within 200 s [s]."""
    for _ in range(2000):
        record = simulation.step()
        if kind in [event.kind for event in record.events]:
            return record.sim_time_s
    return math.inf


@pytest.mark.slow
@pytest.mark.parametrize("extinction_per_m", [0.0, 1.0, 3.0])
def test_18_person_walks_a_hundred_metres_as_slowly_as_frantzich_and_nilsson_measured(tmp_path, extinction_per_m):
    person = {"position": [2.0, 1.0], "speed_mps": 1.25}
    # From x = 2 to 102 m, where the exit begins.
    simulation = mission(tmp_path, (104.0, 2.0), person, extinction_per_m / EXTINCTION_M2_G, 20.0)
    expected_s = 100.0 / (1.25 * (0.706 - 0.057 * extinction_per_m) / 0.706)
    assert time_of(simulation, "victim_safe") == pytest.approx(expected_s, abs=0.5)


@pytest.mark.slow
@pytest.mark.parametrize(("soot_g_m3", "temperature_c"), [(20.0, 20.0), (0.0, 200.0)])
def test_19_person_collapses_when_the_dose_of_gas_or_heat_reaches_one(tmp_path, soot_g_m3, temperature_c):
    person = {"position": [5.0, 5.0], "flees_after_s": 1e6}
    simulation = mission(tmp_path, (10.0, 10.0), person, soot_g_m3, temperature_c)
    co_ppm = soot_g_m3 * 0.04 / 0.06 / 28.01 / (101325.0 / (8.314 * 293.15)) * 1e6
    per_min = 2.764e-5 * math.pow(co_ppm, 1.036) if co_ppm else math.pow(temperature_c, 3.61) / 4.1e8
    assert time_of(simulation, "victim_collapsed") == pytest.approx(60.0 / per_min, abs=1.5)
