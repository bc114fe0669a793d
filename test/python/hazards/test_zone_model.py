"""Two rooms with a fire against CFAST, a zone model: study/fire/zone_model.py has written its results."""

from __future__ import annotations

import csv
import math
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from burning import Doors, advance, fire_of, rooms_with_door

from robotteamsim.hazards import Hazards

RESULTS = Path(__file__).parents[3] / "study" / "fire" / "zone_model.csv"
HEIGHT_M = 2.6
TIMES_S = (120, 180, 240, 300)
AMBIENT_OXYGEN = 0.2049
"""Mole fraction in air of 20 degC and 50 % humidity."""
SOOT_PER_OXYGEN = 0.06 / 20.0 * 13.1
"""Grams of soot per gram of oxygen that a fire uses: 0.06 g per 20 kJ, and 13.1 kJ per gram of oxygen."""


class Air(NamedTuple):
    """The air of a room: temperature [degC], optical density [1/m], mole fraction of oxygen."""

    temperature_c: float
    optical_density_per_m: float
    oxygen: float


def optical_density_per_m(soot_g_m3: float) -> float:
    return 8.7 * soot_g_m3 / math.log(10.0)


@cache
def theirs() -> dict[tuple[str, int, str], Air]:
    """By door, time and room: temperature of the upper layer, and the means of smoke and oxygen over the height."""
    found = {}
    with RESULTS.open(newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            lower_m = float(row["layer_m"])
            upper_m = HEIGHT_M - lower_m
            upper_c, lower_c, upper_oxygen, lower_oxygen, upper_soot, lower_soot = (
                float(row[layer + key]) for key in ("_c", "_oxygen", "_soot_mg_m3") for layer in ("upper", "lower")
            )
            moles = upper_m / (upper_c + 273.15), lower_m / (lower_c + 273.15)
            oxygen = np.average([upper_oxygen, lower_oxygen], weights=moles)
            soot_g_m3 = (upper_soot * upper_m + lower_soot * lower_m) / HEIGHT_M / 1e3
            air = Air(upper_c, optical_density_per_m(soot_g_m3), float(oxygen))
            found[row["door"], int(row["time_s"]), row["room"]] = air
    return found


@cache
def zone_heat_kw() -> dict[tuple[str, int], float]:
    """Heat release rate of the zone model, by door and time."""
    with RESULTS.open(newline="", encoding="utf-8") as file:
        fires = [row for row in csv.DictReader(file) if row["room"] == "fire"]
    return {(row["door"], int(row["time_s"])): float(row["heat_kw"]) for row in fires}


FLAME = {"name": "bin", "polygon": [[2, 2], [3, 2], [3, 3], [2, 3]]}
"""One square metre in the first room, of four cells."""
T_SQUARED = {**FLAME, "growth": "fast", "load_mj_m2": 5000}


def burning(fuel: dict[str, object], diffusivity_m2_s: float) -> Hazards:
    fire = {"fuel": [fuel], "ignitions": [{"position": [2.4, 2.4]}], "soot": {"diffusivity_m2_s": diffusivity_m2_s}}
    return fire_of(rooms_with_door(2.4, 3.6), fire)


@cache
def ours(door: str, diffusivity_m2_s: float) -> dict[tuple[int, str], Air]:
    """The same of our one layer, as means over the floor without flames.

    Our model has no oxygen: this is what is left if the heat has used it and the lack spreads as soot does.
    """
    hazards, doors, begin, found = burning(T_SQUARED, diffusivity_m2_s), Doors(door=door == "closed"), 1, {}
    for time_s in TIMES_S:
        begin = advance(hazards, time_s - begin + 1, doors, begin)
        field = hazards.field
        halves = slice(0, field.states.shape[1] // 2), slice(field.states.shape[1] // 2, None)
        for room, half in zip(("fire", "next"), halves, strict=True):
            temperature_c = float(field.temperatures_c[:, half][field.states[:, half] == 0].mean(dtype=float))
            soot_g_m3 = float(field.soot_g_m3[:, half].mean(dtype=float))
            air_mol_m3 = 101325.0 / (8.314 * (temperature_c + 273.15))
            oxygen = AMBIENT_OXYGEN - soot_g_m3 / SOOT_PER_OXYGEN / 32.0 / air_mol_m3
            found[time_s, room] = Air(temperature_c, optical_density_per_m(soot_g_m3), oxygen)
    return found


@pytest.mark.parametrize(
    ("door", "diffusivity_m2_s", "room", "warming", "optical_density", "oxygen"),
    [
        # The default agrees in the room of the fire, and lets smoke through doors too slowly. 0.0152, 0.453 and 1.022
        # were 0.015, 0.45 and 1.0 while a fire on four cells released 59.7 MJ in five minutes, not 61.4 of 62.8, see
        # the heat below. The closer the heat, the more all ratios exceed those of a fire that is late.
        ("open", 0.15, "fire", (0.9, 1.35), (1.1, 1.5), 0.0152),
        ("open", 0.15, "next", (0.1, 0.5), (0.15, 0.453), 0.015),
        ("closed", 0.15, "fire", (0.9, 1.25), (0.8, 1.022), 0.003),
        ("closed", 0.15, "next", (0.0, 0.1), (0.05, 0.2), 0.003),
        ("open", 0.5, "fire", (0.85, 1.15), (1.0, 1.2), 0.006),
        ("open", 0.5, "next", (0.4, 1.1), (0.45, 0.85), 0.006),
        ("open", 1.0, "fire", (0.75, 1.05), (0.85, 1.1), 0.005),
        ("open", 1.0, "next", (0.7, 1.4), (0.7, 1.0), 0.005),
    ],
)
def test_air_after_two_to_five_minutes_is_that_of_a_zone_model_within(
    door, diffusivity_m2_s, room, warming, optical_density, oxygen
):
    for time_s in TIMES_S:
        ours_, theirs_ = ours(door, diffusivity_m2_s)[time_s, room], theirs()[door, time_s, room]
        share = (ours_.temperature_c - 20.0) / (theirs_.temperature_c - 20.0)
        assert warming[0] <= share <= warming[1], time_s
        share = ours_.optical_density_per_m / theirs_.optical_density_per_m
        assert optical_density[0] <= share <= optical_density[1], time_s
        assert ours_.oxygen == pytest.approx(theirs_.oxygen, abs=oxygen), time_s


def test_heat_is_what_the_zone_model_was_given_and_released():
    """0.0469 kW/s^2 t^2 up to 250 kW, after 73.0 s; to then 6084 kJ, and 250 kW from then on.

    An own curve is released exactly. On four cells, the last cells of a t-squared fire rise after its peak: it lacks
    1.42 MJ, the heat of 5.7 s.
    """
    curve = [[time_s, min(0.0469 * time_s**2, 250.0)] for time_s in range(0, 301)]
    for fuel, missing_kj, rel in (({**FLAME, "hrr": curve}, 0.0, 1e-3), (T_SQUARED, 1420.0, 0.16)):
        hazards, begin = burning(fuel, 0.15), 1
        for time_s in (60, 120, 180, 240, 300):
            begin = advance(hazards, time_s - begin + 1, Doors(door=False), begin)
            assert hazards.heat_release_kw == pytest.approx(zone_heat_kw()["open", time_s], rel=rel)
            if time_s >= 120:
                given_kj = 250.0 * (time_s - 2.0 / 3.0 * math.sqrt(250.0 / 0.0469))
                # Soot is proportional to heat: 0.06 g per 20 kJ.
                assert given_kj - hazards.soot_g * 20.0 / 0.06 == pytest.approx(missing_kj, abs=15.0)


def test_fire_of_the_zone_model_lacks_oxygen_in_a_closed_room_after_six_minutes():
    heat_kw = zone_heat_kw()
    assert heat_kw["open", 540] == heat_kw["closed", 360] == 250.0
    assert heat_kw["closed", 420] < 160.0
