"""JSON Schema of a scenario file, for editors."""

from typing import Any

from robotteamsim.scenario.controllers import ALGORITHMS
from robotteamsim.scenario.scenario import Scenario


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a scenario file; `plan` is a path or a floor plan."""
    schema = Scenario.model_json_schema(by_alias=True)
    plan = schema["properties"]["plan"]
    schema["properties"]["plan"] = {
        "title": "Plan",
        "description": plan["description"],
        "anyOf": [{"type": "string"}, {"$ref": plan["$ref"]}],
    }
    # Only one kind of controller fits each name.
    schema["$defs"]["OtherControl"]["properties"]["algorithm"]["not"] = {"enum": list(ALGORITHMS)}
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
