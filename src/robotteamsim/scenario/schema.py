"""JSON Schema of a scenario file, for editors."""

from typing import Any

from robotteamsim.scenario.controllers import ALGORITHMS
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.schedule import DETAILS, EVENTS


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of a scenario file; `plan` is a path or a floor plan.

    It rejects what the loader rejects, but for what only the loader can compare: numbers with each other, keys that
    exclude each other, names and ids with the team and the plan, and sections with other sections.
    """
    schema = _with_lengths_of_lists(Scenario.model_json_schema(by_alias=True))
    plan, sections = schema["properties"]["plan"], schema["$defs"]
    schema["properties"]["plan"] = {
        "title": "Plan",
        "description": plan["description"],
        "anyOf": [{"type": "string"}, {"$ref": plan["$ref"]}],
    }
    # Only one kind of controller fits each name.
    sections["OtherControl"]["properties"]["algorithm"]["not"] = {"enum": list(ALGORITHMS)}
    # A sensor without a kind is not of the first kind.
    for kind in sections["Team"]["properties"]["sensors"]["items"]["oneOf"]:
        sensor = sections[kind["$ref"].rpartition("/")[2]]
        sensor["required"] = ["kind", *sensor.get("required", ())]
    schema["allOf"] = [_needs("firefighters", "command_centre")]
    for name, rules in _RULES.items():
        sections[name]["allOf"] = rules
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def _with_lengths_of_lists(part: Any) -> Any:
    """Return a part of a schema in which limits of lists, where Pydantic writes those of texts, are in their keys."""
    if isinstance(part, list):
        return [_with_lengths_of_lists(each) for each in part]
    if not isinstance(part, dict):
        return part
    names = {"minLength": "minItems", "maxLength": "maxItems"} if part.get("type") == "array" else {}
    return {names.get(key, key): _with_lengths_of_lists(value) for key, value in part.items()}


def _given(*keys: str) -> dict[str, Any]:
    """Return the rule that a section has keys, which are not null."""
    return {"required": list(keys), "properties": {key: {"not": {"type": "null"}} for key in keys}}


def _needs(key: str, *others: str) -> dict[str, Any]:
    """Return the rule that a section with a key has others, too."""
    return {"if": _given(key), "then": _given(*others)}


def _one_of(*keys: str) -> dict[str, Any]:
    return {"oneOf": [_given(key) for key in keys]}


def _of_kind(kind: str, key: str, other: str, *, is_default: bool = False) -> dict[str, Any]:
    """Return the rule that sections of a kind have a key, and not the other one."""
    condition = {"properties": {"kind": {"const": kind}}, "required": [] if is_default else ["kind"]}
    return {"if": condition, "then": {**_given(key), "not": _given(other)}}


_TEAM = {"anyOf": [_given("start"), {"required": ["start_poses"], "properties": {"start_poses": {"minItems": 1}}}]}

_NOBODY = {"required": ["count"], "properties": {"count": {"const": 0}}}

_RULES: dict[str, list[dict[str, Any]]] = {
    "Team": [{"anyOf": [*_TEAM["anyOf"], _NOBODY]}],
    "Firefighters": [_TEAM],
    "ScheduledEvent": [
        _one_of(*EVENTS),
        *(_needs(detail, event) for detail, event in DETAILS.items()),
        *(_needs(event, detail) for detail, event in DETAILS.items() if detail != "pose"),
    ],
    "Fuel": [_one_of("room", "polygon", "center"), _needs("center", "radius_m"), _needs("radius_m", "center")],
    "MovableObject": [
        _of_kind("box", "size_m", "radius_m", is_default=True),
        _of_kind("barrel", "radius_m", "size_m"),
    ],
    "Region": [
        {"oneOf": [_given("polygon"), _given("center", "radius_m")]},
        _needs("center", "radius_m"),
        _needs("radius_m", "center"),
    ],
}
"""What the loader requires in a section besides its keys, which the types of the keys cannot express."""
