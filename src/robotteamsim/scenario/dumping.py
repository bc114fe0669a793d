"""Writing scenarios and floor plans as YAML, and the JSON Schema of a scenario file, for editors."""

import os
from pathlib import Path
from typing import Any

from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.shipped import shipped_map_name
from robotteamsim.scenario.yaml_text import write


def dump(scenario: Scenario, *, inline_plan: bool = False) -> str:
    """Return a scenario as YAML with every key; `load` reads it back as an equal one.

    A shipped map is written by its name, another plan file by its absolute path.

    Args: inline_plan: write the plan itself even where it came from a file, so that the text is self-contained.
    """
    data = scenario.model_dump(by_alias=True, mode="json")
    if scenario.plan_file and not inline_plan:
        data["plan"] = shipped_map_name(Path(scenario.plan_file)) or scenario.plan_file
    return write(data)


def write_floor_plan(plan: FloorPlan, path: str | os.PathLike[str]) -> None:
    """Write a floor plan as a plan.yaml, leaving out what has its default. Raises: OSError."""
    data = plan.model_dump(by_alias=True, mode="json", exclude_defaults=True)
    Path(path).write_text(write(data), encoding="utf-8")


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a scenario file: `plan` as a path, or written out in place."""
    schema = Scenario.model_json_schema(by_alias=True)
    plan = schema["properties"]["plan"]
    schema["properties"]["plan"] = {
        "title": "Plan",
        "description": plan["description"],
        "anyOf": [{"type": "string"}, {"$ref": plan["$ref"]}],
    }
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
