"""Who located each victim, how exactly, and when: in the tables of bags and in the details of campaigns."""

from __future__ import annotations

import csv
import json

import pytest

from robotteamsim import __version__
from robotteamsim.analysis.runs.files import write_tables
from robotteamsim.analysis.runs.totals import run_totals
from robotteamsim.campaign.design import Trial
from robotteamsim.campaign.trial import run_trial
from robotteamsim.recording.bag_writer import BagWriter
from robotteamsim.recording.replay.reading import read_run
from robotteamsim.recording.results import EventList
from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation

SHORT = ["mission.victims=[{name: ann, position: [9, 6.5]}]", "mission.time_limit_s=60"]


@pytest.mark.slow
def test_table_of_victims_has_the_times_of_the_events_and_who_located_them(tmp_path):
    events = EventList()
    Simulation(load("garage_rescue", SHORT)).run([BagWriter(tmp_path / "short.bag"), events])
    run = read_run([tmp_path / "short.bag"])
    write_tables(tmp_path / "tables", [run], [run_totals(run)])
    with (tmp_path / "tables" / "victims.csv").open(newline="") as file:
        (row,) = csv.DictReader(file)
    by_kind = {event.kind: event for event in reversed(events.events)}
    located = by_kind["victim_located"]
    assert row["victim"] == "ann"
    assert int(row["located_by"]) == located.robot_id
    assert located.detail.endswith(f", {float(row['position_error_m']):.2f} m off")
    for state in ("located", "reported", "reached", "carried", "safe"):
        assert float(row[f"{state}_s"]) == by_kind[f"victim_{state}"].time_s
    assert row["dead_s"] == ""


@pytest.mark.slow
def test_details_of_a_mission_have_the_location_and_the_casualties():
    hot = ["fire.heat.robot_limit_c=10", "fire.heat.robot_endures_s=1", "robots.count=2", "relays.count=0"]
    outcome = run_trial(load("garage_rescue", [*SHORT, *hot]), Trial(0, 0, 1), __version__)
    assert not outcome.failed, outcome.traceback
    details = json.loads(outcome.details)
    ann = details["victims"]["ann"]
    assert ann["located_by"] in range(6)
    assert 0.0 <= ann["position_error_m"] < 2.0
    assert ann["located_s"] is not None
    assert [(one["id"], one["kind"]) for one in details["casualties"]][:2] == [
        (0, "robot_failed_by_heat"),
        (1, "robot_failed_by_heat"),
    ]
