"""The cases of test/data/invalid_scenarios.yaml as files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml
from pydantic import TypeAdapter

from robotteamsim.scenario.sensors import AnySensor

_VALID = """
name: invalid
plan:
  name: room
  bounds: {min: [0, 0], max: [10, 8]}
  walls:
    - {name: divider, from: [6, 0], to: [6, 5]}
  blocks:
    - {name: shelf, polygon: [[1, 6], [3, 6], [3, 7], [1, 7]]}
robots: {count: 2, start: [3, 3, 0]}
"""
_LEFT_OUT = "(left out)"

CASES: dict[str, dict[str, Any]] = yaml.safe_load(
    (Path(__file__).parents[2] / "data" / "invalid_scenarios.yaml").read_text(encoding="utf-8")
)
"""Changes, or the text of the whole file, and the message that refuses it (`expect`), by name."""


def message_of(name: str) -> str:
    """Return the message that rejects an invalid scenario."""
    schema = TypeAdapter(AnySensor).json_schema()
    sensors = (schema["$defs"][one["$ref"].rpartition("/")[2]] for one in schema["oneOf"])
    kinds = ", ".join(sensor["properties"]["kind"]["const"] for sensor in sensors)
    return str(CASES[name]["expect"]).replace("{sensor_kinds}", kinds)


def text_of(name: str) -> str:
    """Return the text of an invalid scenario."""
    case = CASES[name]
    if "text" in case:
        return str(case["text"])
    scenario = yaml.safe_load(_VALID)
    for place, value in case.items():
        if place == "expect":
            continue
        *path, last = [int(key) if key.isdecimal() else key for key in place.split(".")]
        section = scenario
        for key in path:
            section = section[key]
        if value == _LEFT_OUT:
            del section[last]
        else:
            section[last] = value
    return yaml.safe_dump(scenario, sort_keys=False)
