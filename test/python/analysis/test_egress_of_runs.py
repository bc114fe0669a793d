"""Ignition, burnt doors, doses and exits of a small mission: in its result, bag, tables, pictures and recordings."""

from __future__ import annotations

import csv
import json
from io import StringIO
from typing import NamedTuple

import numpy as np
import pytest
from rich.console import Console

from robotteamsim import __version__
from robotteamsim.analysis.runs.files import document, write_tables
from robotteamsim.analysis.runs.picture import draw_runs
from robotteamsim.analysis.runs.tables import print_result, print_run
from robotteamsim.analysis.runs.totals import run_totals
from robotteamsim.campaign.design import Trial
from robotteamsim.campaign.trial import run_trial
from robotteamsim.mission.egress import AT_CENTRE
from robotteamsim.recording import BagWriter, ResultWriter
from robotteamsim.recording.replay.reading import read_run
from robotteamsim.recording.replay.recorded_run import RecordedRun
from robotteamsim.scenario.loading import from_mapping
from robotteamsim.simulation import Result, Simulation
from robotteamsim.view.from_bag import recording_of
from robotteamsim.view.recorder import FrameRecorder, Recording

pytestmark = pytest.mark.slow

FUEL = {"growth": "ultra_fast", "peak_kw_m2": 100}
SCENARIO = {
    "name": "store",
    "plan": {
        "name": "store",
        "bounds": {"max": [20, 6]},
        "walls": [
            {"name": "south", "from": [0, 0.1], "to": [20, 0.1]},
            {"name": "north", "from": [0, 5.9], "to": [20, 5.9]},
            {"name": "low", "from": [12, 0.1], "to": [12, 2.4]},
            {"name": "high", "from": [12, 3.6], "to": [12, 5.9]},
        ],
        "doors": [{"name": "door", "from": [12, 2.4], "to": [12, 3.6], "closed": True}],
    },
    "robots": {"count": 1, "start": [3.0, 1.0, 0.0]},
    "command_centre": [1.5, 1.0],
    "firefighters": {"count": 1, "start": [3.0, 5.0, 0.0], "searches": False},
    "control": {"algorithm": "cover"},
    "fire": {
        "fuel": [
            {"name": "boxes", "polygon": [[9, 0], [12, 0], [12, 6], [9, 6]], **FUEL},
            {"name": "sofa", "polygon": [[10.5, 2], [11, 2], [11, 4], [10.5, 4]], **FUEL},
        ],
        "ignitions": [{"at_s": 2, "position": [11.2, 3.2]}],
        "heat": {"door_endures_s": 5.0},
        "tenability": {"visibility_m": 20.0},
    },
    "mission": {
        "saved_by": "firefighter",
        "time_limit_s": 40.0,
        "rescue": {"safe_m": 0.5},
        "exits": [{"name": "west", "center": [1.0, 3.0]}, {"name": "east", "center": [19.0, 3.0]}],
        "victims": [
            {"name": "ann", "position": [6.0, 3.0], "flees": True, "speed_mps": 1.5, "calling": False},
            {"name": "bob", "position": [16.0, 3.0], "flees": True, "speed_mps": 1.5, "calling": False},
            {"name": "eve", "position": [14.0, 5.0], "calling": False},
        ],
    },
}


class Run(NamedTuple):
    """A mission and what was recorded of it."""

    result: Result
    events: list
    run: RecordedRun
    live: Recording
    replayed: Recording
    document: dict


@pytest.fixture(scope="module")
def fled(tmp_path_factory) -> Run:
    folder = tmp_path_factory.mktemp("fled")
    scenario = from_mapping(SCENARIO, "store.yaml")
    simulation = Simulation(scenario)
    frames, results = FrameRecorder(simulation.setup), ResultWriter(folder / "out")
    result = simulation.run([BagWriter(folder / "store.bag"), results, frames])
    return Run(
        result,
        results.events,
        read_run([folder / "store.bag"]),
        frames.recording,
        recording_of(read_run([folder / "store.bag"]), scenario),
        json.loads((folder / "out" / "mission.json").read_text()),
    )


def printed(show, *values) -> str:
    console = Console(file=StringIO(), width=120)
    show(console, *values)
    return console.file.getvalue()


def test_fire_doors_and_exits_are_events(fled):
    wanted = ("ignition", "door_burnt", "door", "victim_safe")
    found = [(event.kind, event.detail) for event in fled.events if event.kind in wanted]
    begins, spreads = [detail for kind, detail in found if kind == "ignition"]
    assert begins == "fire begins in boxes at (11.2, 3.2)"
    assert spreads.startswith("fire spreads to sofa at (10.")
    assert [detail for kind, detail in found if kind.startswith("door")] == [
        "door door burns through",
        "door door is opened",
    ]
    assert {detail for kind, detail in found if kind == "victim_safe"} == {"ann is safe: west", "bob is safe: east"}


def test_result_has_doses_exits_and_egress_times(fled):
    egress = fled.result.egress
    ann, bob, eve = egress.people
    assert [(one.flees, one.exit) for one in egress.people] == [(True, "west"), (True, "east"), (False, "")]
    assert egress.num_out == {"west": 1, "east": 1}
    assert egress.ignition_s == 2.0
    assert egress.rset_s == max(ann.out_s, bob.out_s) - 2.0
    assert 0.0 < eve.gas < 0.3
    assert eve.least_visibility_m < 20.0
    assert eve.untenable_s is not None
    # Those who flee were safe before.
    assert (egress.aset_s, egress.num_untenable) == (None, 0)
    assert AT_CENTRE not in egress.num_out


def test_bag_has_the_same_egress_and_the_roles_of_the_team(fled):
    assert fled.run.egress == fled.result.egress
    assert [robot.role for robot in fled.run.robots] == ["robot", "firefighter", "command_centre"]
    assert (fled.run.fire.cells == 100).any()
    assert fled.run.smoke.cells.max() > 50


def test_json_has_every_person_and_exit(fled):
    egress = fled.document["result"]["egress"]
    assert egress == json.loads(json.dumps(fled.result.egress.values()))
    (bag,) = document([fled.run], [run_totals(fled.run)])["bags"]
    assert bag["egress"] == fled.result.egress.values()


def test_tables_have_egress_times_and_doses(fled, tmp_path):
    texts = [
        printed(print_result, fled.result, fled.events, []),
        printed(print_run, fled.run, run_totals(fled.run)),
    ]
    rset = f"RSET                  {fled.result.egress.rset_s:.1f} s after ignition: 2 people who flee"
    for text in texts:
        lines = [" ".join(line.split()) for line in text.splitlines()]
        assert " ".join(rset.split()) in lines
        assert "people out 2 of 3: west 1, east 1" in lines
        assert "ASET not reached: nobody met untenable conditions" in lines
        assert any(line.startswith("eve 0.") and line.endswith(" - -") for line in lines)
    write_tables(tmp_path, [fled.run], [run_totals(fled.run)])
    with (tmp_path / "people.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["exit"] for row in rows] == ["west", "east", ""]
    assert float(rows[2]["gas"]) == fled.result.egress.people[2].gas
    with (tmp_path / "exits.csv").open(newline="") as file:
        assert [(row["name"], row["people_out"]) for row in csv.DictReader(file)] == [("west", "1"), ("east", "1")]


def test_picture_shows_fire_smoke_firefighters_and_people_out(fled):
    figure = draw_runs([fled.run], [run_totals(fled.run)])
    legend = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {"smoke", "burning", "command centre"} <= set(legend)
    assert any(text.startswith("firefighter 1: ") for text in legend)
    assert "people out" in [axes.get_ylabel() for axes in figure.axes]
    floor = figure.axes[0]
    # Smoke is densest next to the fire, and there is none at the western end.
    smoke = np.asarray(floor.images[1].get_array())[..., 3]
    assert smoke.max() > 0.3


def test_viewer_shows_the_egress_live_and_from_the_bag(fled):
    live, replayed = fled.live.frames[-1].egress, fled.replayed.frames[-1].egress
    assert live == replayed
    assert live.out == {"west": 1, "east": 1}
    assert live.rset_s == fled.result.egress.rset_s
    assert live.exposures[2][0] == fled.result.egress.people[2].gas > 0.0
    assert fled.live.frames[0].egress.exposures == ()


def test_trial_of_a_campaign_keeps_its_egress(fled):
    outcome = run_trial(from_mapping(SCENARIO, "store.yaml"), Trial(0, 0, 1), __version__)
    assert not outcome.failed, outcome.traceback
    assert outcome.egress == fled.result.egress
