"""Voice: levels and the voice map."""

import math

import numpy as np
import pytest

from robotteamsim.propagation import VoiceField, VoiceSource
from robotteamsim.scenario.floor_plan import Door, Wall
from robotteamsim.scenario.plan import occupancy_grid
from robotteamsim.scenario.sections import Voice


@pytest.mark.parametrize(
    ("constant_db", "exponent", "noise_db", "radius_m"),
    [
        (-78, 5, 10, 22.9),
        (-78, 5, 20, 14.5),
        (-78, 5, 30, 9.1),
        (-72, 6, 10, 10.8),
        (-72, 6, 20, 7.4),
        (-72, 6, 30, 5.0),
    ],
)
def test_voice_is_heard_up_to_its_detection_radius(make_plan, constant_db, exponent, noise_db, radius_m):
    field = VoiceField(make_plan(), Voice())
    source = VoiceSource((0.0, 0.0), float(constant_db), float(exponent))
    assert field.level_db(source, (radius_m - 0.05, 0.0)) > noise_db
    assert field.level_db(source, (radius_m + 0.05, 0.0)) < noise_db


def test_level_falls_by_6_db_per_doubling_of_distance_in_free_field(make_plan):
    field = VoiceField(make_plan(), Voice())
    source = VoiceSource((0.0, 0.0), -75.0, 2.0)
    assert field.level_db(source, (4.0, 0.0)) - field.level_db(source, (8.0, 0.0)) == pytest.approx(6.02, abs=0.01)


@pytest.mark.parametrize("thickness_m", [0.1, 0.8])
def test_every_wall_and_closed_door_costs_the_same(make_plan, thickness_m):
    plan = make_plan(
        walls=(Wall(name="a", start=(5.0, 1.0), end=(5.0, 9.0), thickness_m=thickness_m),),
        doors=(Door(name="d", start=(8.0, 1.0), end=(8.0, 9.0), kind="fireproof", closed=True),),
    )
    source = VoiceSource((2.0, 5.0), -78.0, 5.0)
    behind_both = VoiceField(plan, Voice(wall_loss_db=3.0)).level_db(source, (12.0, 5.0))
    assert behind_both == pytest.approx(78.0 - 50.0 - 2 * 3.0)
    in_the_wall = VoiceField(plan, Voice(wall_loss_db=3.0)).level_db(source, (5.0, 5.0))
    assert in_the_wall == pytest.approx(78.0 - 50.0 * math.log10(3.0) - 1.5)


@pytest.mark.parametrize(("thickness_m", "loss_db"), [(0.1, 0.9989), (0.2, 1.9978), (0.4, 3.9955), (0.8, 7.9910)])
@pytest.mark.parametrize("angle_deg", [0, 60])
def test_loss_of_a_wall_by_thickness_equals_equation_5_at_any_angle(make_plan, thickness_m, loss_db, angle_deg):
    # A = A0 exp(-mu d): 20 cm at mu = 0.0115 per cm leave exp(-0.23) of the amplitude, 1.998 dB.
    wall = Wall(name="a", start=(10.0, 0.0), end=(10.0, 20.0), thickness_m=thickness_m)
    dx, dy = 4.0 * math.cos(math.radians(angle_deg)), 4.0 * math.sin(math.radians(angle_deg))
    source, at = VoiceSource((10.0 - dx, 10.0 - dy), -78.0, 5.0), (10.0 + dx, 10.0 + dy)
    voice = Voice(wall_model="thickness")
    behind = VoiceField(make_plan(walls=(wall,)), voice).level_db(source, at)
    assert VoiceField(make_plan(), voice).level_db(source, at) - behind == pytest.approx(loss_db, abs=1e-4)


def test_concrete_of_20_cm_costs_between_1_7_and_6_1_db(make_plan):
    plan = make_plan(walls=(Wall(name="a", start=(5.0, 1.0), end=(5.0, 9.0)),))
    source = VoiceSource((2.0, 5.0), -78.0, 5.0)
    for attenuation_per_cm, loss_db in ((0.01, 1.737), (0.035, 6.080)):
        voice = Voice(wall_model="thickness", attenuation_per_cm=attenuation_per_cm)
        assert VoiceField(plan, voice).level_db(source, (12.0, 5.0)) == pytest.approx(28.0 - loss_db, abs=5e-4)


def test_half_a_wall_and_a_closed_door_cost_their_thickness(make_plan):
    plan = make_plan(
        walls=(Wall(name="a", start=(5.0, 1.0), end=(5.0, 9.0), thickness_m=0.8),),
        doors=(Door(name="d", start=(8.0, 1.0), end=(8.0, 9.0), closed=True, thickness_m=0.06),),
    )
    voice = Voice(wall_model="thickness", attenuation_per_cm=0.02)
    per_cm_db = 0.02 * 8.685889638
    field = VoiceField(plan, voice)
    assert field.level_db(VoiceSource((5.0, 5.0), -78.0, 2.0), (6.0, 5.0)) == pytest.approx(78.0 - 40.0 * per_cm_db)
    source = VoiceSource((7.5, 5.0), -78.0, 2.0)
    assert field.level_db(source, (8.5, 5.0)) == pytest.approx(78.0 - 6.0 * per_cm_db)
    field.set_door("d", False)
    assert field.level_db(source, (8.5, 5.0)) == pytest.approx(78.0)


def test_voice_map_by_thickness_is_the_level_of_each_cell(flat):
    voice = Voice(wall_model="thickness", attenuation_per_cm=0.035, noise_db=15.0, map_resolution_m=0.5)
    field = VoiceField(flat, voice)
    source = VoiceSource((2.1, 3.3), -78.0, 2.0)
    voice_map = field.map_db([source])
    heard = voice_map.values > 0.0
    assert 100 < np.count_nonzero(heard) < heard.size
    for row, column in zip(*np.nonzero(heard), strict=True):
        level_db = field.level_db(source, voice_map.cell_center(row, column))
        assert voice_map.values[row, column] == pytest.approx(level_db, abs=5e-5)


def test_map_is_the_highest_level_above_the_noise_in_every_free_cell(flat):
    voice = Voice(noise_db=30.0, map_resolution_m=0.5)
    field = VoiceField(flat, voice)
    sources = [VoiceSource((2.1, 3.3), -78.0, 5.0), VoiceSource((11.0, 16.5), -73.0, 5.8)]
    voice_map = field.map_db(sources)
    occupied = occupancy_grid(flat.model_copy(update={"doors": ()}), 0.5).cells == 100
    assert occupied.any()
    for row, column in np.ndindex(voice_map.values.shape):
        best = max(field.level_db(source, voice_map.cell_center(row, column)) for source in sources)
        heard = best >= 30.0 and not occupied[row, column]
        assert voice_map.values[row, column] == pytest.approx(best if heard else 0.0, abs=5e-5)


def test_map_is_written_into_the_array_given_and_no_other_memory(flat):
    field = VoiceField(flat, Voice(map_resolution_m=0.5))
    sources = [VoiceSource((2.1, 3.3), -78.0, 5.0)]
    out = np.full((40, 40), np.nan, dtype=np.float32)
    voice_map = field.map_db(sources, out=out, threads=2)
    assert voice_map.values is out
    assert out.tobytes() == field.map_db(sources).values.tobytes()


def test_map_without_sources_is_silent(flat):
    assert not VoiceField(flat, Voice()).map_db([]).values.any()


def test_more_noise_leaves_fewer_cells(flat):
    field = VoiceField(flat, Voice())
    sources = [VoiceSource((9.0, 9.0), -75.0, 5.5)]
    cells = []
    for noise_db in (0.0, 10.0, 20.0, 30.0):
        field.set_noise_db(noise_db)
        cells.append(np.count_nonzero(field.map_db(sources).values))
    assert cells == sorted(set(cells), reverse=True)


def test_door_opened_and_closed_restores_the_voice_map_to_the_bit(flat):
    field = VoiceField(flat, Voice())
    sources = [VoiceSource((9.4, 14.0), -78.0, 5.0)]
    before = field.map_db(sources).values
    field.set_door("glass", True)
    assert np.any(field.map_db(sources).values < before)
    field.set_door("glass", False)
    assert field.map_db(sources).values.tobytes() == before.tobytes()


def test_position_that_is_not_finite_is_rejected(flat):
    field = VoiceField(flat, Voice())
    with pytest.raises(ValueError, match=r"^position of a voice must be finite"):
        field.map_db([VoiceSource((math.nan, 1.0), -78.0, 5.0)])
    with pytest.raises(ValueError, match=r"^at_m must be finite"):
        field.level_db(VoiceSource((1.0, 1.0), -78.0, 5.0), (math.nan, 1.0))


@pytest.mark.parametrize("noise_db", [-1.0, math.nan, math.inf])
def test_noise_must_be_finite_and_not_negative(flat, noise_db):
    with pytest.raises(ValueError, match="noise_db must be finite and >= 0"):
        VoiceField(flat, Voice()).set_noise_db(noise_db)


@pytest.mark.parametrize(
    ("constant_db", "exponent", "message"),
    [
        (math.nan, 5.0, "constant_db must be finite, got nan"),
        (-math.inf, 5.0, "constant_db must be finite, got -inf"),
        (-78.0, math.nan, "exponent must be finite and > 0, got nan"),
        (-78.0, math.inf, "exponent must be finite and > 0, got inf"),
        (-78.0, 0.0, "exponent must be finite and > 0, got 0.0"),
    ],
)
def test_voice_of_no_finite_level_is_rejected(constant_db, exponent, message):
    with pytest.raises(ValueError, match=f"^{message}$"):
        VoiceSource((1.0, 1.0), constant_db, exponent)
