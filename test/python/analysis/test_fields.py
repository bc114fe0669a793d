"""Radio and voice maps of a scenario."""

from __future__ import annotations

import numpy as np
import pytest

from robotteamsim.analysis.fields.maps import (
    default_resolution_m,
    map_arrays,
    radio_panel,
    radio_style,
    voice_panel,
    voice_style,
)
from robotteamsim.analysis.fields.picture import FieldStyle, Panel, Spot
from robotteamsim.errors import RecordingError
from robotteamsim.propagation import FieldMap, RadioField, VoiceField, VoiceSource
from robotteamsim.scenario import load
from robotteamsim.scenario.sections import Network, Radio, Voice
from robotteamsim.sensing.voice import VoiceSensor


def test_radio_map_holds_the_strongest_transmitter_of_each_cell(hall_scenario):
    scenario = hall_scenario()
    at_m = [(3.0, 4.0), (17.0, 8.0)]
    panel = radio_panel(scenario, at_m, 0.25, loss=False)
    both = [RadioField(scenario.plan, scenario.radio).rssi_map_dbm(place, 0.25).values for place in at_m]
    np.testing.assert_array_equal(panel.field.values, np.maximum(*both))
    assert [spot.position_m for spot in panel.spots] == at_m
    assert panel.title == "strongest of 2 transmitters, 0 dBm"
    assert panel.silent_below == -94.0


def test_path_loss_does_not_depend_on_the_transmit_power(hall_scenario):
    maps = [
        radio_panel(hall_scenario(radio=Radio(tx_power_dbm=power)), [(3.0, 4.0)], 0.5, loss=True).field.values
        for power in (0.0, 20.0)
    ]
    np.testing.assert_allclose(maps[0], maps[1], atol=1e-4)  # maps are float32
    assert maps[0].min() > 0.0


def test_robot_0_transmits_when_no_place_is_given(hall_scenario):
    (spot,) = radio_panel(hall_scenario(), [], 0.5, loss=False).spots
    assert spot.position_m == (3.0, 4.0)


@pytest.mark.parametrize(("voice_range", "constant_db", "exponent"), [("lowest", -72.0, 6.0), ("highest", -78.0, 5.0)])
def test_voice_range_takes_one_end_for_all_victims(hall_scenario, voice_range, constant_db, exponent):
    scenario = hall_scenario()
    panel = voice_panel(scenario, [], 0.25, voice_range)
    sources = [VoiceSource(victim.position, constant_db, exponent) for victim in scenario.mission.victims]
    expected = VoiceField(scenario.plan, scenario.voice).map_db(sources)
    np.testing.assert_array_equal(panel.field.values, expected.values)
    assert f"{exponent:g}" in panel.title


def test_drawn_voice_map_equals_the_levels_that_robots_hear(hall_scenario):
    scenario = hall_scenario(seed=3)
    panel = voice_panel(scenario, [], 0.25, "drawn")
    sensor = VoiceSensor(scenario.plan, scenario.voice, scenario.mission.victims, 3)
    np.testing.assert_array_equal(panel.field.values, sensor.map().values)
    assert panel.title == "10 dB of noise, as drawn by seed 3"
    assert [spot.name for spot in panel.spots] == ["ann", "bob"]


def test_voices_may_be_anywhere(hall_scenario):
    panel = voice_panel(hall_scenario(), [(5.0, 5.0), (6.0, 5.0)], 0.25, "highest")
    assert [spot.name for spot in panel.spots] == ["victim_1", "victim_2"]
    assert [spot.position_m for spot in panel.spots] == [(5.0, 5.0), (6.0, 5.0)]


def test_radio_levels_are_those_of_the_network_and_two_more(hall_scenario):
    scenario = hall_scenario(network=Network(endangered_below_dbm=-75.0, lost_below_dbm=-90.0))
    style = radio_style([scenario], loss=False)
    assert {level.value: level.meaning for level in style.levels} == {
        -60.0: "",
        -70.0: "",
        -75.0: "endangered",
        -90.0: "lost",
    }
    assert (style.low, style.high, style.unit) == (-90.0, -47.4, "dBm")
    loss = radio_style([scenario], loss=True)
    assert [(level.value, level.meaning) for level in loss.levels][:2] == [(90.0, "lost"), (75.0, "endangered")]
    assert (loss.low, loss.high, loss.unit) == (47.4, 106.0, "dB")


def test_scale_holds_all_scenarios_that_are_compared(hall_scenario):
    quiet, loud = (hall_scenario(voice=Voice(noise_db=noise_db)) for noise_db in (10.0, 30.0))
    style = voice_style([loud, quiet])
    assert (style.low, style.high) == (10.0, 78.0)
    assert [level.value for level in style.levels] == [10.0, 20.0, 30.0]
    weak, strong = (hall_scenario(radio=Radio(tx_power_dbm=power)) for power in (0.0, 10.0))
    assert radio_style([weak, strong], loss=False).high == pytest.approx(-37.4)


def test_voice_levels_start_at_the_noise(hall_scenario):
    style = voice_style([hall_scenario(voice=Voice(noise_db=15.0))])
    assert [level.value for level in style.levels] == [15.0, 20.0, 30.0]
    assert [level.value for level in voice_style([hall_scenario(voice=Voice(noise_db=0.0))]).levels] == [10, 20, 30]


def test_default_resolution_gives_600_cells_in_whole_centimetres(hall_scenario):
    assert default_resolution_m(load("garage_sar").plan) == 0.1
    assert default_resolution_m(hall_scenario().plan) == 0.03
    assert default_resolution_m(load("tutorial_arena").plan) == 0.02


def _panel(columns: int = 3) -> Panel:
    spots = (Spot("ann", (1.5, 2.5), "victim"),)
    return Panel("a map", FieldMap((-1.0, 2.0), 0.5, np.arange(2.0 * columns).reshape(2, columns)), None, spots)


@pytest.mark.parametrize("count", [1, 2])
def test_arrays_of_maps_have_values_places_and_names(count):
    arrays = map_arrays([_panel()] * count, FieldStyle("voice level", "dB", "YlOrRd", low=10.0, high=60.0))
    assert arrays["values"].shape == ((2, 3) if count == 1 else (2, 2, 3))
    assert arrays["values"].ravel()[:6].tolist() == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    assert (arrays["origin_m"].tolist(), float(arrays["resolution_m"])) == ([-1.0, 2.0], 0.5)
    assert (str(arrays["quantity"]), str(arrays["unit"])) == ("voice level", "dB")
    assert arrays["titles"].tolist() == ["a map"] * count
    assert arrays["sources_m"].tolist() == [[1.5, 2.5]] * count
    assert arrays["source_map"].tolist() == list(range(count))


def test_maps_of_different_cells_do_not_fit_into_one_file():
    with pytest.raises(RecordingError, match=r"^maps with different cells do not fit into one file"):
        map_arrays([_panel(), _panel(columns=2)], FieldStyle("voice level", "dB", "YlOrRd", low=10.0, high=60.0))
