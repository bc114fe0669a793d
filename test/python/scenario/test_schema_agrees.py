"""Whether the schema and the loader judge scenarios alike: hundreds are drawn from the schema, half of them damaged."""

from __future__ import annotations

import copy
import itertools
import random
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario import json_schema
from robotteamsim.scenario.loading import from_mapping

sys.path.append(str(Path(__file__).parents[2] / "fuzz"))
import random_missions

NUM_SCENARIOS = 500

COMPARED = re.compile(
    r"needs? (run\.world|control\.algorithm|the section)|there is no|not allowed|only allowed (together )?with"
    r"|with algorithm"
    r"|(below|above|between) [a-z]|is the only"
    r"|does not divide|whole number of nanoseconds|has values from|leaves none|is outside|lies outside|swings into"
    r"|is not at a wall|already|another|not in the order|crosses itself"
    r"|^robots(\.count: 0 is below 1|: missing)"  # unless somebody leaves by exits
    r"|^plan: 'text' is not a section"  # only files name their plan
)
"""Refusals of what only the loader can compare."""


def drawn(seed: int) -> Iterator[dict[str, Any]]:
    """Yield scenarios without an end, most of which the loader accepts, and damaged ones."""
    generator, tried = random.Random(seed), []

    def is_accepted(data: dict[str, Any]) -> bool:
        tried.append(copy.deepcopy(data))
        return accepts(data)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(random_missions, "is_accepted", is_accepted)
        maker = random_missions.MissionMaker(generator)
        while True:
            maker.mission()
            for data in tried:
                yield data
                yield damaged(data, generator)
            tried.clear()


def damaged(data: dict[str, Any], generator: random.Random) -> dict[str, Any]:
    """Return a scenario of which one section lacks a key, has another one, or another value."""
    data = copy.deepcopy(data)
    sections = list(_sections(data))
    section = generator.choice(sections)
    key = generator.choice([*section, "unknown"])
    values = [None, True, -1e9, 1e9, 0.04, 3, "text", [], [1.0, 2.0], {}]
    if generator.random() < 0.3:
        section.pop(key, None)
    else:
        section[key] = generator.choice(values)
    return data


def _sections(data: Any) -> Iterator[dict[str, Any]]:
    if isinstance(data, dict):
        yield data
        data = list(data.values())
    if isinstance(data, list):
        for value in data:
            yield from _sections(value)


def refusal(data: dict[str, Any]) -> str:
    """Return why the loader refuses a scenario; "" if it accepts it."""
    try:
        from_mapping(data, "drawn")
    except ScenarioError as error:
        return str(error).removeprefix("drawn: ")
    return ""


def accepts(data: dict[str, Any]) -> bool:
    return not refusal(data)


@pytest.mark.slow
def test_schema_and_loader_judge_drawn_scenarios_alike():
    validator, seen = jsonschema.Draft202012Validator(json_schema()), set()
    for data in itertools.islice(drawn(seed=20_26), NUM_SCENARIOS):
        refused, errors = refusal(data), [error.message for error in validator.iter_errors(data)]
        seen.add((bool(refused), bool(errors)))
        if not (COMPARED.search(refused) and not errors):
            assert bool(refused) == bool(errors), (refused, errors, data)
    assert seen >= {(False, False), (True, True)}


BOX = {"name": "box", "pose": [5.0, 5.0, 0.0]}
MINIMAL = {
    "name": "x",
    "plan": {"name": "p", "bounds": {"max": [10, 10]}},
    "robots": {"count": 1, "start": [2, 2, 0]},
}


@pytest.mark.parametrize(
    ("changed", "line"),
    [
        ({}, ""),
        ({"radio": {"door_loss_db": 0.3, "wall_loss_db": [0.6, 1.2, 12, 120.0]}}, ""),
        ({"radio": {"door_loss_db": 0.81}}, "radio.door_loss_db: 0.81 is not a multiple of 0.1"),
        ({"radio": {"materials": {"glass": 0.05}}}, "radio.materials.glass: 0.05 is not a multiple of 0.1"),
        ({"run": {"seed": 7.0}}, ""),
        ({"run": {"seed": 7.5}}, "run.seed: 7.5 is not a whole number"),
        ({"run": {"seed": -1.0}}, "run.seed: -1 is below 0"),
        ({"run": {"seed": True}}, "run.seed: true is not a whole number"),
        ({"robots": []}, "robots: has 0 items; expected at least 1"),
        ({"robots": {"count": 1}}, "robots.start: missing; expected [x, y, yaw], or start_poses instead"),
        ({"robots": {"count": 1, "start_poses": [[2, 2, 0]]}}, ""),
        ({"robots": {"start": [2, 2, 0], "sensors": [{}]}}, "robots.sensors.0.kind: missing; expected one of"),
        ({"schedule": [{"at_s": 1.0}]}, "schedule.0: expected exactly one of remove, "),
        ({"schedule": [{"at_s": 1.0, "victim": "a"}]}, "schedule.0.position: missing; expected [x, y]"),
        ({"schedule": [{"at_s": 1.0, "victim": "a", "position": [2, 2]}]}, ""),
        ({"schedule": [{"at_s": 1.0, "noise_db": 9, "lit": True}]}, "schedule.0.lit: only allowed with light"),
        ({"objects": [BOX]}, "objects.0.size_m: missing; expected length and width of a box [m]"),
        ({"objects": [{**BOX, "size_m": [0.5, 0.5]}]}, ""),
        ({"objects": [{**BOX, "kind": "barrel", "size_m": [0.5, 0.5]}]}, "objects.0.radius_m: missing; expected"),
        ({"fire": {"fuel": [{"name": "f"}]}}, "fire.fuel.0: expected exactly one of room, polygon, center; found none"),
        ({"fire": {"fuel": [{"name": "f", "center": [5, 5]}]}}, "fire.fuel.0.radius_m: missing; expected together"),
        ({"fire": {"fuel": [{"name": "f", "center": [5, 5], "radius_m": 1.0}]}}, ""),
    ],
)
def test_schema_requires_what_the_loader_requires(changed, line):
    data = {**MINIMAL, **changed}
    assert refusal(data).startswith(line)
    assert bool(refusal(data)) == bool(line)
    assert jsonschema.Draft202012Validator(json_schema()).is_valid(data) == (not line)


def test_whole_numbers_with_a_point_are_those_without():
    def of(one: float) -> dict[str, Any]:
        places = [([2, 2], one), ([4, 2], 0 * one)]
        vertices = [{"position": place, "neighbours": [other], "lengths_m": [2.0]} for place, other in places]
        sonar = {"kind": "sonar", "name": "front", "rays": 9 * one}
        return {
            **MINIMAL,
            "robots": {
                "count": 2 * one,
                "start": [2, 2, 0],
                "sensors": [sonar],
            },
            "command_centre": 0 * one,
            "mission": {"patrol": {"graph": {"vertices": vertices}}},
            "schedule": [{"at_s": 1.0, "remove": one}],
        }

    assert refusal(of(1)) == ""
    assert from_mapping(of(1.0), "drawn") == from_mapping(of(1), "drawn")
    assert repr(from_mapping(of(1.0), "drawn")) == repr(from_mapping(of(1), "drawn"))  # where 1 and 1.0 differ
    assert jsonschema.Draft202012Validator(json_schema()).is_valid(of(1.0))


@pytest.mark.parametrize("robots", [{"robots": {"count": 0}}, {}])
def test_people_may_leave_without_a_team(robots):
    people = {
        "mission": {"exits": [{"name": "west", "center": [1, 5], "radius_m": 1.0}]},
        "people": {"groups": [{"name": "staff", "count": 2, "region": {"center": [7, 5], "radius_m": 1.0}}]},
    }
    data = {key: value for key, value in MINIMAL.items() if key != "robots"} | robots | people
    assert refusal(data) == ""
    assert jsonschema.Draft202012Validator(json_schema()).is_valid(data)
