"""Presets of radios: defaults of keys in `radio` and `network`. docs/propagation.md has the source of each value."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

MEASURED_CONSTANT_LOSS_DB = 47.4
"""l0 + l_c at 2.45 GHz [dissertation, Table 3; borrelli2004]."""
MEASURED_AT_MHZ = 2450.0


def constant_loss_db(frequency_mhz: float) -> float:
    """Return l0 + l_c at another frequency, to 0.1 dB: free-space loss grows by 20 log10(f) [itu_p525, eq. 4]."""
    return round(MEASURED_CONSTANT_LOSS_DB + 20.0 * math.log10(frequency_mhz / MEASURED_AT_MHZ), 1)


PRESETS: Mapping[str, Mapping[str, Mapping[str, float]]] = {
    "none": {"radio": {}, "network": {}},
    "wifi_2_4_ghz": {
        "radio": {"tx_power_dbm": 20.0, "constant_loss_db": MEASURED_CONSTANT_LOSS_DB},
        "network": {"endangered_below_dbm": -74.0, "lost_below_dbm": -82.0},
    },
    "wifi_5_ghz": {
        "radio": {"tx_power_dbm": 23.0, "constant_loss_db": constant_loss_db(5250.0), "frequency_mhz": 5250.0},
        "network": {"endangered_below_dbm": -74.0, "lost_below_dbm": -82.0},
    },
    "zigbee": {
        "radio": {"tx_power_dbm": 0.0, "constant_loss_db": MEASURED_CONSTANT_LOSS_DB},
        "network": {"endangered_below_dbm": -85.0, "lost_below_dbm": -95.0},
    },
    "lora_868_mhz": {
        "radio": {"tx_power_dbm": 16.0, "constant_loss_db": constant_loss_db(868.0), "frequency_mhz": 868.0},
        "network": {"endangered_below_dbm": -124.0, "lost_below_dbm": -137.0},
    },
}
"""Name, section, key and value; keys that a preset lacks keep their defaults, those of Table 3 at 2.45 GHz."""


def with_preset(section: str, data: Any, name: Any) -> Any:
    """Return the YAML data of a section with the keys of a preset below its own.

    Invalid data and unknown presets are returned unchanged: validation reports them.
    """
    if not isinstance(name, str) or name not in PRESETS or not isinstance(data, dict):
        return data
    return {**PRESETS[name][section], **data}
