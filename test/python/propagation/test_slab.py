"""The radio loss of walls of layers: published figures, a second method, limits, and its way into the faces."""

from __future__ import annotations

import math
from typing import get_args

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from robotteamsim.errors import ScenarioError
from robotteamsim.propagation import RadioField
from robotteamsim.propagation.faces import radio_faces
from robotteamsim.propagation.slab import MOST_DB, permittivity, wall_loss_db
from robotteamsim.scenario import from_mapping, load
from robotteamsim.scenario.floor_plan import Bounds, FloorPlan, Wall
from robotteamsim.scenario.materials import Layer, Material, Substance
from robotteamsim.scenario.sections import Radio

LAYERS = st.lists(
    st.builds(Layer, of=st.sampled_from(get_args(Substance)), thickness_m=st.floats(1e-4, 0.3)), min_size=1, max_size=5
)
MHZ = st.floats(400.0, 40_000.0)


def of(*layers):
    return [Layer(of=substance, thickness_m=thickness_m) for substance, thickness_m in layers]


@pytest.mark.parametrize(
    ("layers", "frequency_mhz", "loss_db"),
    [
        (of(("plasterboard", 0.0125), ("air", 0.075), ("plasterboard", 0.0125)), 2450.0, 1.2),
        (of(("plasterboard", 0.025), ("air", 0.075), ("plasterboard", 0.025)), 2450.0, 3.1),
        (of(("brick", 0.115)), 2450.0, 3.6),
        (of(("brick", 0.24)), 2450.0, 6.4),
        (of(("concrete", 0.1)), 2450.0, 8.1),
        (of(("concrete", 0.2)), 2450.0, 14.7),
        (of(("concrete", 0.3)), 2450.0, 21.2),
        (of(("wood", 0.04)), 2450.0, 0.6),
        (of(("chipboard", 0.04)), 2450.0, 2.0),
        (of(("glass", 0.006)), 2450.0, 2.0),
        (of(("concrete", 0.2)), 868.0, 7.4),
        (of(("concrete", 0.2)), 5500.0, 26.2),
    ],
)
def test_walls_lose_what_the_recommendation_gives(layers, frequency_mhz, loss_db):
    assert wall_loss_db(layers, frequency_mhz) == pytest.approx(loss_db, abs=0.1 + 1e-9)


def reflected_again_and_again(layers, frequency_mhz, share):
    """Return the transmitted power by adding one boundary after the other (Parratt's recursion)."""
    indices = [1.0, *(np.sqrt(permittivity(layer.of, frequency_mhz)) for layer in layers), 1.0]
    depths = [share * layer.thickness_m for layer in layers] + [0.0]
    wave_number = 2.0 * math.pi * frequency_mhz * 1e6 / 299_792_458.0
    reflected, passed = 0.0, 1.0
    for front, back, depth_m in reversed(list(zip(indices, indices[1:], depths, strict=False))):
        way = np.exp(-1j * wave_number * back * depth_m)
        fresnel = (front - back) / (front + back)
        behind = reflected * way**2
        passed = (1.0 + fresnel) * way * passed / (1.0 + fresnel * behind)
        reflected = (fresnel + behind) / (1.0 + fresnel * behind)
    return abs(passed) ** 2


@given(LAYERS, MHZ)
@example([Layer(of="chipboard", thickness_m=0.3)], 36749.0)  # opaque where it is thickest
def test_a_second_method_gives_the_same_loss_and_the_other_side_too(layers, frequency_mhz):
    found_db = wall_loss_db(layers, frequency_mhz)
    assert wall_loss_db(layers[::-1], frequency_mhz) == pytest.approx(found_db, abs=0.1)
    powers = [reflected_again_and_again(layers, frequency_mhz, share) for share in np.linspace(0.9, 1.1, 101)]
    power = float(np.mean(powers))
    expected_db = -10.0 * math.log10(power) if power > 1e-12 else MOST_DB
    assert found_db == pytest.approx(min(expected_db, MOST_DB), abs=0.06)


def test_air_loses_nothing_and_metal_everything():
    assert wall_loss_db(of(("air", 1.0)), 2450.0) == 0.0
    assert wall_loss_db(of(("metal", 0.001)), 2450.0) == MOST_DB
    assert wall_loss_db(of(("concrete", 1e-9)), 2450.0) == 0.0


STUD = Material(name="stud", layers=of(("plasterboard", 0.0125), ("air", 0.075), ("plasterboard", 0.0125)))
PLAN = FloorPlan(
    name="hall",
    bounds=Bounds(max=(10.0, 10.0)),
    walls=(
        Wall(name="thin", start=(0.0, 5.0), end=(10.0, 5.0), thickness_m=0.1, material="stud"),
        Wall(name="thick", start=(0.0, 7.0), end=(10.0, 7.0), thickness_m=0.1),
    ),
    materials=(STUD,),
)


@pytest.mark.parametrize(
    ("radio", "loss_db"),
    [
        (Radio(), 3.8),
        (Radio(walls="material"), 1.2),
        (Radio(walls="material", frequency_mhz=5250.0), wall_loss_db(STUD.layers, 5250.0)),
        (Radio(walls="material", materials={"stud": 6.0}), 6.0),
    ],
)
def test_loss_of_a_wall_is_that_of_its_layers_if_wanted(radio, loss_db):
    free = PLAN.model_copy(update={"walls": ()})
    ends = (5.0, 4.0), (5.0, 6.0)
    without_db = RadioField(free, radio).path_loss_db(*ends)
    assert RadioField(PLAN, radio).path_loss_db(*ends) - without_db == pytest.approx(loss_db, abs=1e-9)
    ends = (5.0, 6.0), (5.0, 8.0)
    assert RadioField(PLAN, radio).path_loss_db(*ends) - RadioField(free, radio).path_loss_db(*ends) == pytest.approx(
        3.8
    )


def test_preset_sets_the_frequency():
    assert load("garage_sar", ["radio.preset=lora_868_mhz"]).radio.frequency_mhz == 868.0
    assert load("garage_sar").radio.frequency_mhz == 2450.0


@pytest.mark.parametrize(
    ("change", "line"),
    [
        ({"layers": []}, r"plan.materials.0.layers: has 0 items; expected at least 1"),
        ({"layers": [{"of": "gypsum", "thickness_m": 0.1}]}, r"plan.materials.0.layers.0.of: 'gypsum'"),
        ({"layers": [{"of": "air", "thickness_m": 0.0}]}, r"plan.materials.0.layers.0.thickness_m: 0.0 is below"),
        ({"name": "other"}, r"radio.materials: has no 'stud', the material of 'thin' in the plan; known: other"),
    ],
)
def test_mistake_in_a_material_is_named(change, line):
    data = load("garage_sar").model_dump(mode="json", by_alias=True, exclude_defaults=True)
    plan = PLAN.model_dump(mode="json", by_alias=True, exclude_defaults=True)
    plan["materials"][0] |= change
    data |= {"plan": plan, "mission": {"time_limit_s": 10.0}, "robots": {"count": 1, "start": [2.0, 2.0, 0.0]}}
    with pytest.raises(ScenarioError, match=line):
        from_mapping(data, "hall")


def test_faces_of_a_published_plan_are_as_before():
    plan = load("garage_sar").plan
    assert radio_faces(plan, Radio()) == radio_faces(plan, Radio(walls="material"))
