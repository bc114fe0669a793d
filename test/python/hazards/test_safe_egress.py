"""Doses, lost visibility and untenable exits of missions, in smoke or heat that is the same everywhere."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fds_run import write_run

from robotteamsim.mission.events import Event
from robotteamsim.scenario.loading import from_mapping
from robotteamsim.simulation import Result, Simulation

SIZE_M = (20.0, 6.0)
ANN = {"name": "ann", "position": [16.0, 3.0], "flees": True, "flees_after_s": 5.0, "speed_mps": 1.0}
BOB = {**ANN, "name": "bob", "position": [12.0, 1.0], "flees_after_s": 1e6}
HOT_C = 300.0
HEAT_PER_MIN = math.pow(HOT_C, 3.61) / 4.1e8
"""Growth of the dose at HOT_C."""


def run(
    folder: Path, soot_g_m3: float, temperature_c: float, time_limit_s: float, **fire: Any
) -> tuple[Result, list[Event]]:
    """Run a mission; ann is at the exit, 3 m from her, after 5 + 2 s."""
    constant = {"TEMPERATURE": ("temp", "C", temperature_c), "SOOT DENSITY": ("rho_soot", "kg/m3", soot_g_m3 / 1e3)}
    slices = [
        (quantity, label, unit, lambda x, y, time_s, value=value: np.full(x.shape, value))
        for quantity, (label, unit, value) in constant.items()
    ]
    heat = {"block_c": 2000.0, "robot_limit_c": 2000.0, "flame_c": 150.0}
    data = {
        "name": "smoke",
        "plan": {"name": "room", "bounds": {"max": list(SIZE_M)}},
        "robots": {"count": 1, "start": [0.5, 0.5, 0.0]},
        "command_centre": 0,
        "firefighters": {"count": 1, "start": [0.5, 1.5, 0.0], "searches": False, "block_c": 2000.0},
        "control": {"algorithm": "cover"},
        "fire": {"fds": write_run(folder, slices, SIZE_M), "heat": heat, **fire},
        "mission": {
            "saved_by": "firefighter",
            "victims": [{**one, "calling": False} for one in (ANN, BOB)],
            "exits": [{"name": "east", "center": [19.0, 3.0]}],
            "rescue": {"safe_m": 0.1},
            "walk_update_s": 0.1,
            "time_limit_s": time_limit_s,
        },
    }
    events: list[Event] = []
    simulation = Simulation(from_mapping(data, "smoke.yaml"))
    simulation.mission.start()

    class Watch:
        def begin(self, setup):
            pass

        def step(self, record):
            events.extend(record.events)

        def end(self, result):
            pass

        def abandon(self):
            pass

    return simulation.run([Watch()]), events


def kinds(events: list[Event], *wanted: str) -> list[tuple[str, str]]:
    return [(event.kind, event.subject) for event in events if event.kind in wanted]


@pytest.mark.slow
def test_dose_by_heat_ends_the_available_time_of_who_stays_and_of_the_exit(tmp_path):
    result, events = run(tmp_path, 0.0, HOT_C, 12.0)
    egress = result.egress
    ann, bob = egress.people
    # The first dose is that of the first update, after 1 s.
    assert egress.ignition_s == 0.0
    expected_s = 60.0 * 0.3 / HEAT_PER_MIN
    assert (ann.exit, ann.untenable_s, ann.out_s) == ("east", None, pytest.approx(7.0, abs=0.5))
    assert ann.heat == pytest.approx(HEAT_PER_MIN / 60.0 * ann.out_s, abs=HEAT_PER_MIN / 60.0)
    assert bob.untenable_s == pytest.approx(expected_s, abs=1.0)
    assert (bob.out_s, bob.exit) == (None, "")
    assert bob.heat == pytest.approx(HEAT_PER_MIN * 11.0 / 60.0, abs=HEAT_PER_MIN / 60.0)
    assert egress.exits[0].untenable_s == bob.untenable_s
    assert egress.exits[0].heat == pytest.approx(bob.heat)
    assert (egress.rset_s, egress.aset_s) == (None, bob.untenable_s)
    assert egress.num_out == {"east": 1}
    assert kinds(events, "ignition", "visibility_lost", "exit_untenable", "victim_safe") == [
        ("ignition", ""),
        ("victim_safe", "ann"),
        ("exit_untenable", "east"),
    ]


@pytest.mark.parametrize(
    ("soot_g_m3", "tenability", "lost"),
    [
        (0.05, {}, ["ann", "bob"]),  # 3 / (8.7 * 0.05) = 6.9 m
        (0.05, {"visibility_m": 5.0}, []),
        (0.05, {"visibility_m": 0.0}, []),
        (0.03, {}, []),  # 11.5 m
    ],
)
def test_people_who_see_less_far_than_the_limit_have_lost_visibility(tmp_path, soot_g_m3, tenability, lost):
    result, events = run(tmp_path, soot_g_m3, 20.0, 3.0, tenability=tenability)
    assert [name for _, name in kinds(events, "visibility_lost")] == lost
    assert [person.name for person in result.egress.people if person.untenable_s is not None] == lost
    assert kinds(events, "exit_untenable") == ([("exit_untenable", "east")] if lost else [])
    for person in result.egress.people:
        assert person.least_visibility_m == pytest.approx(3.0 / (8.7 * soot_g_m3), rel=1e-3)
    if lost:
        detail = next(event.detail for event in events if event.kind == "visibility_lost")
        assert detail == "ann sees only 6.9 m far"
