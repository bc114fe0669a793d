"""Missions drawn from the schema of scenarios: a small building, and any keys that the loader accepts together."""

from __future__ import annotations

import copy
import math
import random
from typing import Any

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.loading import from_mapping
from robotteamsim.scenario.schema import json_schema
from robotteamsim.setup import resolve

WIDTH_M, DEPTH_M, DOOR_M = 9.0, 6.0, 1.2
LONGEST_S, MOST_STEPS = 6.0, 60

SMALL = {
    "beams": 90,
    "count": 6,
    "every_steps": 20,
    "fewest_beams": 90,
    "height_px": 48,
    "memory_terms": 50,
    "physics_substeps": 20,
    "random_victims": 5,
    "rays": 30,
    "width_px": 64,
}
"""Largest values of keys that cost time or memory, so that many missions can be made."""

LARGE = {"cell_m": 0.25, "longest_substep_s": 0.01, "map_resolution_m": 0.2, "timestep_s": 0.002, "walk_update_s": 0.2}
"""Smallest values of such keys."""

IDS = {"base", "command_centre", "remove", "spawn"}
LENGTHS = {"size_m"}
INTERVALS = {"constant_db": (-120.0, 0.0), "exponent": (0.1, 10.0)}
KEPT = {"fds", "graph", "name", "plan", "autostart", "localisation"}
"""Keys that the mission already has, that need files, or that only ROS has."""

Schema = dict[str, Any]


class MissionMaker:
    """Draws missions; those of one generator are always the same."""

    def __init__(self, generator: random.Random) -> None:
        self._generator = generator
        self._schema = json_schema()
        self._names = 0

    def mission(self) -> dict[str, Any]:
        """Return the data of a scenario that the loader accepts, with up to 40 keys changed."""
        data = self._building()
        for _ in range(self._generator.randint(0, 40)):
            changed = copy.deepcopy(data)
            self._change(changed, self._schema)
            if is_accepted(changed):
                data = changed
        step_s = data.get("run", {}).get("step_s", 0.1)
        data.setdefault("mission", {})["time_limit_s"] = min(LONGEST_S, MOST_STEPS * step_s)
        return data

    def _building(self) -> dict[str, Any]:
        """Return a mission of robots in two rooms with a door."""
        generator = self._generator
        x = round(generator.uniform(3.0, 6.0), 2)
        door = round(generator.uniform(0.3, DEPTH_M - DOOR_M - 0.3), 2)
        corners = [[0.0, 0.0], [WIDTH_M, 0.0], [WIDTH_M, DEPTH_M], [0.0, DEPTH_M]]
        lines = [
            *zip(corners, corners[1:] + corners[:1], strict=True),
            ([x, 0.1], [x, door]),
            ([x, door + DOOR_M], [x, DEPTH_M - 0.1]),
        ]
        walls = [{"name": f"wall_{i}", "from": start, "to": end} for i, (start, end) in enumerate(lines)]
        leaf = {"name": "door", "from": [x, door], "to": [x, door + DOOR_M]}
        for key, choices in (
            ("closed", [False, True]),
            ("kind", ["normal", "fireproof"]),
            ("motion", ["instant", "swing", "slide"]),
        ):
            leaf[key] = generator.choice(choices)
        bounds = {"min": [-0.5, -0.5], "max": [WIDTH_M + 0.5, DEPTH_M + 0.5]}
        plan = {"name": "rooms", "bounds": bounds, "walls": walls, "doors": [leaf]}
        start = [1.5, round(generator.uniform(1.5, DEPTH_M - 1.5), 2), 0.0]
        robots: Any = {"count": generator.randint(1, 5), "start": start, "spacing_m": 0.6}
        if generator.random() < 0.5:
            robots = [{"start_pose": [1.0, 0.8 + 0.7 * i, 0.0]} for i in range(generator.randint(1, 6))]
        return {"name": "random", "plan": plan, "robots": robots}

    def _change(self, data: dict[str, Any], schema: Schema) -> None:
        """Give one key of a section, or of a section in it, another value."""
        generator = self._generator
        keys = [key for key in schema["properties"] if key not in KEPT]
        if not keys:
            return
        key = generator.choice(keys)
        value = self._resolved(schema["properties"][key])
        old = data.get(key)
        if value.get("type") == "object" and "properties" in value and self._fits(old, value):
            self._change(data.setdefault(key, {}), value)
        elif value.get("type") == "array" and isinstance(old, (list, tuple)) and old and "items" in value:
            item = self._resolved(value["items"])
            if item.get("type") == "object" and generator.random() < 0.7:
                self._change(generator.choice(old), item)
            else:
                data[key] = [*old, self._drawn(key, item)]
        else:
            data[key] = self._drawn(key, value)

    def _fits(self, old: Any, schema: Schema) -> bool:
        """Whether a section can have keys of a schema: it is not there, and nothing is required, or of that kind."""
        if old is None:
            return not schema.get("required")
        if not isinstance(old, dict):
            return False
        tags = {key: value["const"] for key, value in schema["properties"].items() if "const" in value}
        return all(old.get(key, tag) == tag for key, tag in tags.items())

    def _resolved(self, schema: Schema) -> Schema:
        """Return a schema without references, and one of several at random."""
        while True:
            if "$ref" in schema:
                schema = self._schema["$defs"][schema["$ref"].rpartition("/")[2]]
            elif "anyOf" in schema or "oneOf" in schema:
                choices = schema.get("anyOf") or schema["oneOf"]
                schema = self._generator.choice([each for each in choices if each.get("type") != "null"])
            else:
                return schema

    def _drawn(self, key: str, schema: Schema) -> Any:
        """Return a value of a key."""
        generator, schema = self._generator, self._resolved(schema)
        if "const" in schema:
            return schema["const"]
        if "enum" in schema:
            return generator.choice(schema["enum"])
        match schema.get("type"):
            case "boolean":
                return generator.random() < 0.5
            case "integer":
                return generator.randint(0, 8) if key in IDS else round(self._number(key, schema))
            case "number":
                return self._number(key, schema)
            case "string":
                return self._text(key)
            case "array":
                return self._list(key, schema)
        wanted = schema.get("required", [])  # a list: the order of a set differs from run to run
        drawn = {name: self._drawn(name, schema["properties"][name]) for name in wanted}
        others = [name for name in schema.get("properties", ()) if name not in KEPT.union(wanted)]
        for name in generator.sample(others, min(len(others), generator.randint(0, 3))):
            drawn[name] = self._drawn(name, schema["properties"][name])
        return drawn

    def _number(self, key: str, schema: Schema) -> float:
        """Return a number in the range of the schema: often its ends, else any order of magnitude."""
        low = schema.get("minimum", schema.get("exclusiveMinimum", -10.0))
        high = schema.get("maximum", schema.get("exclusiveMaximum", 10.0))
        high, low = min(high, SMALL.get(key, high)), max(low, LARGE.get(key, low))
        if "exclusiveMinimum" in schema and schema["type"] == "number":
            low = math.nextafter(low, math.inf)
        if "exclusiveMaximum" in schema:
            high = math.nextafter(high, -math.inf)
        generator, default = self._generator, schema.get("default")
        choice = generator.random()
        if choice < 0.15:
            return low
        if choice < 0.3:
            return high
        if choice < 0.6 and isinstance(default, (int, float)):
            return min(max(default * generator.choice([0.5, 0.9, 1.1, 2.0]), low), high)
        if choice < 0.8 and low >= 0.0:
            least = max(low, high * 1e-6)
            return min(max(math.exp(generator.uniform(math.log(least), math.log(high))), low), high)
        return generator.uniform(low, high)

    def _text(self, key: str) -> str:
        if key in ("door", "fireproof"):
            return "door"
        if key in ("light", "victim"):
            return f"{key}_{self._generator.randint(0, 2)}"
        self._names += 1
        return f"item_{self._names}"

    def _list(self, key: str, schema: Schema) -> list[Any]:
        generator, length = self._generator, len(schema.get("prefixItems", ()))
        if key in INTERVALS:
            return sorted(generator.uniform(*INTERVALS[key]) for _ in range(2))
        if key in LENGTHS:
            return [round(generator.choice([0.02, generator.uniform(0.05, 0.8)]), 3) for _ in range(length)]
        if length:
            return self._place()[:2] + [round(generator.uniform(-4.0, 4.0), 3)] * (length - 2)
        if key == "footprint_m":
            return self._polygon(0.0, 0.0, generator.uniform(0.03, 0.4))
        if key == "polygon":
            return self._polygon(*self._place(), generator.uniform(0.05, 3.0))
        least = max(schema.get("minItems", 0), 1)
        return [
            self._drawn(key, schema["items"])
            for _ in range(min(generator.randint(least, least + 2), schema.get("maxItems", 9)))
        ]

    def _place(self) -> list[float]:
        """Return a place in the building, sometimes in its walls."""
        generator = self._generator
        return [round(generator.uniform(0.2, WIDTH_M - 0.2), 2), round(generator.uniform(0.2, DEPTH_M - 0.2), 2)]

    def _polygon(self, x: float, y: float, radius_m: float) -> list[list[float]]:
        corners = sorted(self._generator.uniform(0.0, math.tau) for _ in range(self._generator.randint(3, 7)))
        return [[x + radius_m * math.cos(angle), y + radius_m * math.sin(angle)] for angle in corners]


def is_accepted(data: dict[str, Any]) -> bool:
    """Whether the loader accepts a scenario, and everybody has room."""
    try:
        resolve(from_mapping(data, "random"))
    except ScenarioError:
        return False
    return True
