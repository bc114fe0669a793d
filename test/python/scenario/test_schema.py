"""The JSON Schema that editors complete and check scenarios with."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import jsonschema
import pytest
from invalid_scenarios import text_of

from robotteamsim.scenario import json_schema, scenario_names
from robotteamsim.scenario.controllers import ALGORITHMS
from robotteamsim.scenario.shipped import shipped_scenario
from robotteamsim.scenario.yaml_text import parse

VALIDATOR = jsonschema.Draft202012Validator


def _data(path: Path) -> Any:
    return parse(path.read_text(encoding="utf-8"), path.name)


@pytest.mark.slow
def test_schema_is_valid_json_schema() -> None:
    VALIDATOR.check_schema(json_schema())


@pytest.mark.slow
@pytest.mark.parametrize("name", scenario_names())
def test_shipped_scenario_agrees_with_the_schema(name: str) -> None:
    VALIDATOR(json_schema()).validate(_data(shipped_scenario(name)))


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("unknown_key", "Additional properties are not allowed ('nois_db' was unexpected)"),
        ("above_range", "99 is greater than the maximum of 80.0"),
        ("wrong_choice", "'publised' is not one of ['published', 'grunwald_letnikov']"),
    ],
)
def test_schema_and_load_reject_the_same_values(name: str, message: str) -> None:
    data = parse(text_of(name), name)
    errors = list(VALIDATOR(json_schema()).iter_errors(data))
    for error in errors:
        errors += error.context or ()  # of each kind of controller
    assert message in [error.message for error in errors]


@pytest.mark.slow
def test_controller_fits_one_kind_in_the_schema() -> None:
    data = parse(text_of("wrong_choice"), "a")
    for algorithm in (*ALGORITHMS, "my_module:Mine"):
        VALIDATOR(json_schema()).validate({**data, "control": {"algorithm": algorithm, "iteration_s": 2.0}})


def test_every_key_of_a_section_says_what_it_means() -> None:
    for name, section in json_schema()["$defs"].items():
        for key, value in section["properties"].items():
            assert "description" in value or "$ref" in value, f"{name}.{key}"


def test_plan_may_be_a_path_or_written_out() -> None:
    plan = json_schema()["properties"]["plan"]
    assert plan["anyOf"] == [{"type": "string"}, {"$ref": "#/$defs/FloorPlan"}]
