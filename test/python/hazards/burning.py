"""Plans and scenarios with a fire, for tests."""

from __future__ import annotations

from collections.abc import Mapping

from robotteamsim.hazards import Hazards
from robotteamsim.scenario import from_mapping
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.scenario import Scenario

STEP_NS = 10**9
"""One step per update."""

HALL = {"name": "hall", "bounds": {"max": [20, 20]}}
"""An empty hall without inner walls."""

LARGE_HALL = {"name": "large hall", "bounds": {"max": [40, 40]}}

ROOMS = {
    "name": "rooms",
    "bounds": {"max": [12, 6]},
    "walls": [{"name": "south", "from": [6, 0], "to": [6, 2.4]}, {"name": "north", "from": [6, 3.6], "to": [6, 6]}],
    "doors": [{"name": "door", "from": [6, 2.4], "to": [6, 3.6], "closed": True}],
}
"""Two rooms of 6 x 6 m with a door between them."""


class Doors:
    """States of doors that a test sets."""

    def __init__(self, **closed: bool) -> None:
        self._closed = closed
        self.version = 1

    def closed(self) -> dict[str, bool]:
        return dict(self._closed)

    def set(self, name: str, closed: bool) -> None:
        self._closed[name] = closed
        self.version += 1


def rooms_with_door(low_m: float, high_m: float) -> dict[str, object]:
    """ROOMS with another doorway."""
    south, north = ROOMS["walls"]
    return {
        **ROOMS,
        "walls": [{**south, "to": [6, low_m]}, {**north, "from": [6, high_m]}],
        "doors": [{**ROOMS["doors"][0], "from": [6, low_m], "to": [6, high_m]}],
    }


def scenario(plan: Mapping[str, object], fire: Mapping[str, object], seed: int = 1, **sections: object) -> Scenario:
    """A fire that grows exactly as its class, unless the fire has another `growth_sd`."""
    base = {
        "name": "burning",
        "plan": dict(plan),
        "robots": [{"start_pose": [1.0, 1.0, 0.0]}],
        "fire": {"growth_sd": 0.0, **fire},
        "run": {"seed": seed, "step_s": 1.0, "physics_substeps": 20},
    }
    return from_mapping({**base, **sections}, "burning")


def fire_of(*arguments: object, **sections: object) -> Hazards:
    """Return the fire of such a scenario."""
    burning = scenario(*arguments, **sections)
    return Hazards(burning, Building(burning.plan))


def door_of_kind(kind: str) -> dict[str, object]:
    return {**ROOMS, "doors": [{**ROOMS["doors"][0], "kind": kind}]}


def everywhere(plan: Mapping[str, object] = HALL, **fuel: object) -> dict[str, object]:
    """Fuel on the whole floor of a plan."""
    x, y = plan["bounds"]["max"]
    return {"name": "carpet", "polygon": [[0, 0], [0, y], [x, y], [x, 0]], **fuel}


def advance(hazards: Hazards, seconds: int, doors: Doors | None = None, begin: int = 1) -> int:
    """Step through some seconds, from step `begin` on; return the next step."""
    doors = doors or Doors()
    for step in range(begin, begin + seconds):
        hazards.step((step + 1) * STEP_NS, doors)
    return begin + seconds
