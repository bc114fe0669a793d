"""`radio.preset`: defaults of a radio technology, which explicit keys override."""

from __future__ import annotations

from pathlib import Path
from typing import get_args

import pytest

from robotteamsim.propagation import RadioField
from robotteamsim.scenario import Scenario, dump, load
from robotteamsim.scenario.radio_presets import PRESETS
from robotteamsim.scenario.sections import Radio

NAMES = get_args(Radio.model_fields["preset"].annotation)


def values(scenario: Scenario) -> tuple[float, ...]:
    radio, network = scenario.radio, scenario.network
    return radio.tx_power_dbm, radio.constant_loss_db, network.endangered_below_dbm, network.lost_below_dbm


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("none", (0.0, 47.4, -80.0, -94.0)),
        ("wifi_2_4_ghz", (20.0, 47.4, -74.0, -82.0)),
        ("wifi_5_ghz", (23.0, 54.0, -74.0, -82.0)),  # 47.4 + 20 log10(5250 / 2450)
        ("zigbee", (0.0, 47.4, -85.0, -95.0)),
        ("lora_868_mhz", (16.0, 38.4, -124.0, -137.0)),  # 47.4 + 20 log10(868 / 2450)
    ],
)
def test_preset_sets_power_loss_and_thresholds(name: str, expected: tuple[float, ...]) -> None:
    assert values(load("garage_sar", [f"radio.preset={name}"])) == expected


def test_every_preset_is_a_choice_of_the_key() -> None:
    assert tuple(PRESETS) == NAMES
    for name in NAMES:
        load("office_manet", [f"radio.preset={name}"])


def test_explicit_keys_override_the_preset_in_file_and_settings(tmp_path: Path) -> None:
    path = tmp_path / "own.yaml"
    path.write_text(
        "name: own\nplan: garage\nrobots: {start: [4, 5, 0]}\n"
        "radio: {preset: zigbee, tx_power_dbm: 3.0}\nnetwork: {lost_below_dbm: -90.0}\n"
    )
    assert values(load(path)) == (3.0, 47.4, -85.0, -90.0)
    assert values(load(path, ["radio.constant_loss_db=50", "network.endangered_below_dbm=-70"])) == (
        (3.0, 50.0, -70.0, -90.0)
    )
    assert values(load("office_manet", ["radio.preset=wifi_5_ghz"]))[0] == -4.0  # that of the file


def test_dumped_scenario_with_a_preset_is_loaded_with_equal_values(tmp_path: Path) -> None:
    scenario = load("garage_sar", ["radio.preset=lora_868_mhz", "radio.tx_power_dbm=10"])
    path = tmp_path / "dumped.yaml"
    path.write_text(dump(scenario))
    assert load(path) == scenario


def test_signal_of_zigbee_is_lost_at_113_m_in_free_space() -> None:
    """10^((95 - 47.4) / 23.2) = 112.6 m."""
    scenario = load("garage_sar", ["radio.preset=zigbee"])
    field = RadioField(scenario.plan.model_copy(update={"walls": (), "blocks": (), "doors": ()}), scenario.radio)
    near, far = (-field.path_loss_db((0.0, 0.0), (x_m, 0.0)) for x_m in (112.0, 113.0))
    assert near > scenario.network.lost_below_dbm > far
