"""Tests of ISO 20414 for models of evacuation, as far as they apply to people who flee [iso20414].

test_crowd.py has those of counter-flows and flows, test_iso_20414_smoke.py those of smoke; study/people lists all.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import pytest

from robotteamsim.scenario.loading import from_mapping
from robotteamsim.simulation import Simulation, StepRecord

Point = tuple[float, float]
STEP_S = 0.1


def wall(name: str, start: Point, end: Point) -> dict[str, Any]:
    return {"name": name, "from": list(start), "to": list(end), "thickness_m": 0.2}


def flees(name: str, position: Point, speed_mps: float = 1.0, after_s: float = 0.0) -> dict[str, Any]:
    return {
        "name": name,
        "position": list(position),
        "flees": True,
        "flees_after_s": after_s,
        "speed_mps": speed_mps,
        "calling": False,
    }


def evacuate(
    plan: dict[str, Any], people: Sequence[dict[str, Any]], exits: Sequence[Point], **sections: Any
) -> list[StepRecord]:
    """Run a mission until everybody is safe. A robot, which is the centre, and a firefighter stand west of x = -2 m."""
    data = {
        "name": "evacuation",
        "plan": plan,
        "robots": {"count": 1, "start": [-3.0, 0.6, 0.0]},
        "command_centre": 0,
        "firefighters": {"count": 1, "start": [-3.0, -0.6, 0.0], "searches": False},
        "control": {"algorithm": "cover"},
        "mission": {
            "saved_by": "firefighter",
            "victims": list(people),
            "exits": [{"name": f"exit_{i}", "center": list(exit_m)} for i, exit_m in enumerate(exits)],
            "time_limit_s": 200.0,
            "walk_update_s": STEP_S,
        },
    }
    simulation = Simulation(from_mapping({**data, **sections}, "evacuation.yaml"))
    simulation.mission.start()
    records = [simulation.step()]
    while records[-1].mission.state != "ended":
        records.append(simulation.step())
    assert records[-1].mission.end == "victims_safe"
    return records


def safe_after_s(records: list[StepRecord], index: int = 0) -> float:
    return next(record.sim_time_s for record in records if record.mission.victims[index] == "safe")


CORRIDOR = {
    "name": "corridor",
    "bounds": {"min": [-4.0, -1.2], "max": [46.0, 1.2]},
    "walls": [wall("south", (-4.0, -1.1), (46.0, -1.1)), wall("north", (-4.0, 1.1), (46.0, 1.1))],
}
ROOM = {
    "name": "room",
    "bounds": {"min": [-5.0, -1.0], "max": [12.0, 6.0]},
    "walls": [
        wall("south", (-0.1, -0.1), (8.1, -0.1)),
        wall("north", (-0.1, 5.1), (8.1, 5.1)),
        wall("west_1", (-0.1, 0.0), (-0.1, 2.0)),
        wall("west_2", (-0.1, 3.0), (-0.1, 5.0)),
        wall("east_1", (8.1, 0.0), (8.1, 2.0)),
        wall("east_2", (8.1, 3.0), (8.1, 5.0)),
    ],
    "doors": [
        {"name": "east", "from": [8.1, 2.0], "to": [8.1, 3.0], "thickness_m": 0.2},
        {"name": "west", "from": [-0.1, 2.0], "to": [-0.1, 3.0], "thickness_m": 0.2},
    ],
}
"""A room of 8 x 5 m with a door of 1 m in the west and in the east."""
EAST, WEST = (10.0, 2.5), (-2.0, 2.5)


@pytest.mark.slow
def test_1_everybody_starts_at_their_pre_evacuation_time():
    times_s = [10.0 * (i + 1) for i in range(10)]
    people = [
        flees(f"p{i}", (1.0 + 1.2 * (i % 5), 1.2 + 2.0 * (i // 5)), after_s=time_s) for i, time_s in enumerate(times_s)
    ]
    records = evacuate(ROOM, people, [EAST])
    for index, time_s in enumerate(times_s):
        moved = (record for record in records if record.victims[index].position != tuple(people[index]["position"]))
        assert next(moved).sim_time_s == pytest.approx(time_s, abs=STEP_S)


@pytest.mark.slow
def test_2_person_needs_forty_seconds_for_forty_metres_at_one_metre_per_second():
    # The exit begins 1 m before its centre.
    assert safe_after_s(evacuate(CORRIDOR, [flees("ann", (2.0, 0.0))], [(43.0, 0.0)])) == pytest.approx(40.0, abs=0.2)


@pytest.mark.slow
def test_4_twenty_people_walk_around_a_corner_and_through_no_wall():
    corner = {
        "name": "corner",
        "bounds": {"min": [-5.0, -1.2], "max": [11.0, 15.0]},
        "walls": [
            wall("south", (-5.0, -0.1), (10.2, -0.1)),
            wall("east", (10.1, 0.0), (10.1, 15.0)),
            wall("north", (-5.0, 2.1), (8.0, 2.1)),
            wall("inside", (7.9, 2.2), (7.9, 15.0)),
        ],
    }
    people = [flees(f"p{i}", (0.4 + 0.6 * (i // 3), 0.4 + 0.6 * (i % 3))) for i in range(20)]
    records = evacuate(corner, people, [(9.0, 13.0)], robots={"count": 1, "start": [-3.0, 0.6, 0.0]})
    for record in records:
        for x, y in (victim.position for victim in record.victims):
            beyond_corner_m = math.hypot(8.0 - x, y - 2.0) if x < 8.0 and y < 2.0 else math.inf
            gap_m = min(10.0 - x, y, beyond_corner_m, 2.0 - y if x < 8.0 else x - 8.0 if y > 2.0 else math.inf)
            assert gap_m > 0.1, (record.sim_time_s, x, y)


@pytest.mark.slow
def test_7_fast_people_overtake_a_slow_one_in_a_corridor():
    slow = flees("slow", (4.0, 0.0), speed_mps=0.4)
    people = [slow, *(flees(f"p{i}", (1.0 + 0.8 * (i // 2), -0.3 + 0.6 * (i % 2)), 1.25) for i in range(6))]
    records = evacuate(CORRIDOR, people, [(43.0, 0.0)])
    assert safe_after_s(records, 0) == pytest.approx(38.0 / 0.4, rel=0.02)
    for index in range(1, 7):
        alone_s = (42.0 - people[index]["position"][0]) / 1.25
        assert alone_s < safe_after_s(records, index) < 1.1 * alone_s


@pytest.mark.parametrize(
    ("schedule", "way_out", "path_m"),
    [
        ([], EAST, 3.0),
        ([{"at_s": 1.0, "door": "east", "closed": True}], WEST, 1.0 + 8.0),  # 1 m to the nearest one and back
    ],
)
def test_9_person_takes_the_nearest_exit_and_another_when_it_closes(schedule, way_out, path_m):
    records = evacuate(ROOM, [flees("ann", (6.0, 2.5))], [EAST, WEST], schedule=schedule)
    assert math.dist(records[-1].victims[0].position, way_out) <= 1.0
    assert safe_after_s(records) == pytest.approx(path_m / 1.0, abs=0.3)
