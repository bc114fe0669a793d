"""Victims whom a firefighter does not see: they are felt for, and call again if they are not found."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from robotteamsim.control.driving.hot_places import HotPlaces
from robotteamsim.control.driving.known_map import known_map
from robotteamsim.control.people.felt_floor import FeltFloor
from robotteamsim.scenario.loading import from_mapping
from robotteamsim.setup import resolve
from robotteamsim.simulation import Simulation, StepRecord

HALL = {
    "name": "hall",
    "bounds": {"min": [0.0, 0.0], "max": [20.0, 10.0]},
    "walls": [
        {"name": "south", "from": [0, 0.1], "to": [20, 0.1], "thickness_m": 0.2},
        {"name": "north", "from": [0, 9.9], "to": [20, 9.9], "thickness_m": 0.2},
        {"name": "west", "from": [0.1, 0.2], "to": [0.1, 9.8], "thickness_m": 0.2},
        {"name": "east", "from": [19.9, 0.2], "to": [19.9, 9.8], "thickness_m": 0.2},
    ],
}


def blind(**dispatch: Any) -> Any:
    """Return a scenario in which nobody sees: the firefighter's voice fix of ann, 5 m away, is all that is known."""
    return from_mapping(
        {
            "name": "blind",
            "plan": HALL,
            "robots": {"count": 0, "start": [4.0, 2.0, 0.0]},
            "command_centre": [1.5, 5.0],
            "firefighters": {"count": 1, "start": [9.5, 5.0, 0.0], "searches": False, "dispatch": dispatch},
            "control": {"algorithm": "cover"},
            "mission": {
                "saved_by": "firefighter",
                "rescue": {"sight_m": 0.0},
                "victims": [{"name": "ann", "position": [12.5, 5.0]}],
                "time_limit_s": 240.0,
            },
        },
        "blind.yaml",
    )


def kinds_of(scenario: Any) -> tuple[list[str], StepRecord]:
    simulation = Simulation(scenario)
    simulation.mission.start()
    kinds: list[str] = []
    while simulation.mission.status.state != "ended":
        record = simulation.step()
        kinds += [event.kind for event in record.events if event.kind.startswith("victim_")]
    return kinds, record


def test_firefighter_who_sees_nobody_feels_their_way_to_the_victim():
    kinds, record = kinds_of(blind(feel_s=120.0))
    assert "victim_not_found" not in kinds
    assert record.mission.victims == ("safe",)


@pytest.mark.slow
def test_victim_who_is_not_found_calls_again_and_is_located_better():
    kinds, record = kinds_of(blind(feel_s=0.0))
    first = kinds.index("victim_not_found")
    assert "victim_located" in kinds[:first]
    assert "victim_located" in kinds[first:]
    assert record.mission.victims == ("safe",)


@pytest.mark.parametrize("place", [(10.0, 5.0), (2.0, 2.0)])
def test_all_free_floor_around_a_place_is_felt(place):
    setup = resolve(blind())
    near_m, radius_m = 0.6, 4.0
    known = known_map(setup.building, 0.25)
    felt = FeltFloor(known, place, radius_m, near_m)
    position, visited = (place[0] + 2.0, place[1]), []
    hot = HotPlaces(setup.scenario.plan, 60.0)
    for step in range(1000):
        point = felt.next_point(position, 0.1 * step, hot)
        if point is None:
            break
        position = point
        visited.append(position)
    assert point is None
    assert visited[0] == place
    for x, y in np.random.default_rng(1).uniform(-radius_m, radius_m, (500, 2)).tolist():
        victim = (place[0] + x, place[1] + y)
        if math.hypot(x, y) <= radius_m - 0.5 and known.grid.is_free(victim):
            assert min(math.dist(victim, at) for at in visited) <= near_m + 0.5
