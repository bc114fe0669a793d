"""The loss of voices by the mass of walls: a second method, hand-calculated numbers, and its way into the field."""

from __future__ import annotations

import math
from typing import get_args

import numpy as np
import pytest

from robotteamsim.propagation import VoiceField, VoiceSource
from robotteamsim.propagation.mass_law import DENSITIES_KG_M3, mass_law_loss_db
from robotteamsim.scenario.floor_plan import Bounds, Door, FloorPlan, Wall
from robotteamsim.scenario.materials import Layer, Material, Substance
from robotteamsim.scenario.sections import Voice

STUD = (
    Layer(of="plasterboard", thickness_m=0.0125),
    Layer(of="air", thickness_m=0.075),
    Layer(of="plasterboard", thickness_m=0.0125),
)


@pytest.mark.parametrize(
    ("layers", "loss_db"),
    [
        ((Layer(of="glass", thickness_m=0.006),), 30.1),  # 20 log10(500 * 15) - 47.4
        (STUD, 33.7),  # 22.59 kg/m^2
        ((Layer(of="brick", thickness_m=0.115),), 52.9),
        ((Layer(of="concrete", thickness_m=0.11),), 55.0),
        ((Layer(of="air", thickness_m=0.1),), 0.0),
        ((Layer(of="metal", thickness_m=2.0),) * 40, 120.0),
    ],
)
def test_loss_follows_from_the_mass(layers, loss_db):
    assert mass_law_loss_db(layers, 500.0) == pytest.approx(loss_db, abs=0.05)


@pytest.mark.parametrize("substance", [one for one in get_args(Substance) if one != "air"])
@pytest.mark.parametrize("frequency_hz", [500.0, 1000.0, 2000.0])
def test_loss_is_that_of_sound_from_all_directions_up_to_78_degrees(substance, frequency_hz):
    layer = Layer(of=substance, thickness_m=0.05)
    cosines = np.linspace(math.cos(math.radians(78.0)), 1.0, 20_001)
    ratio = math.pi * frequency_hz * DENSITIES_KG_M3[substance] * 0.05 / 413.0
    transmitted = np.trapezoid(2.0 * cosines / (1.0 + (ratio * cosines) ** 2), cosines)
    transmitted /= 1.0 - cosines[0] ** 2
    assert mass_law_loss_db((layer,), frequency_hz) == pytest.approx(-10.0 * math.log10(transmitted), abs=0.6)


WALLS = (
    Wall(name="built", start=(0.0, 5.0), end=(10.0, 5.0), thickness_m=0.1, material="stud"),
    Wall(name="unknown", start=(0.0, 7.0), end=(10.0, 7.0), thickness_m=0.1),
    Wall(name="west", start=(0.0, 9.0), end=(4.0, 9.0), thickness_m=0.1, material="stud"),
)
DOOR = Door(name="door", start=(4.0, 9.0), end=(6.0, 9.0), closed=True)
PLAN = FloorPlan(
    name="hall",
    bounds=Bounds(max=(10.0, 10.0)),
    walls=WALLS,
    doors=(DOOR,),
    materials=(Material(name="stud", layers=STUD),),
)


@pytest.mark.parametrize(
    ("voice", "y_m", "loss_db"),
    [
        (Voice(), (4.0, 6.0), 2.0),
        (Voice(wall_model="material"), (4.0, 6.0), 33.7),
        (Voice(wall_model="material", frequency_hz=1000.0), (4.0, 6.0), 39.7),
        (Voice(wall_model="material"), (6.0, 8.0), 2.0),
        (Voice(wall_model="material", wall_loss_db=3.5), (8.0, 9.5), 3.5),
        (Voice(wall_model="material"), (4.0, 9.5), 33.7 + 2.0 + 2.0),
    ],
)
def test_voice_loses_the_loss_of_the_material_and_that_of_eq_6_elsewhere(voice, y_m, loss_db):
    source = VoiceSource((5.0, y_m[0]), -78.0, 2.0)
    free_db = 78.0 - 20.0 * math.log10(y_m[1] - y_m[0])
    assert VoiceField(PLAN, voice).level_db(source, (5.0, y_m[1])) == pytest.approx(free_db - loss_db, abs=1e-9)
