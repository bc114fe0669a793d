from __future__ import annotations

import json
import re

import pytest

import robotteamsim
from robotteamsim.campaign import Trial, run_trial
from robotteamsim.campaign import trial as trial_module
from robotteamsim.errors import CampaignError
from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation

VERSION = robotteamsim.__version__


def test_trial_is_the_mission_of_that_seed(short_design):
    design = short_design("voice.noise_db=20")
    outcome = run_trial(design.cells[0].scenario, Trial(0, 1, 123), VERSION)
    settings = ["run.seed=123", "voice.noise_db=20", "mission.time_limit_s=1"]
    result = Simulation(load("tutorial_arena", settings)).run()
    assert outcome.trajectory_hash == result.trajectory_hash
    assert (outcome.time_s, outcome.end, outcome.num_areas, outcome.steps) == (1.0, "time_limit", 4, result.steps)
    assert not outcome.failed


def test_details_hold_the_times_of_areas_and_victims(hall_scenario):
    outcome = run_trial(hall_scenario(), Trial(0, 1, 1), VERSION)
    details = json.loads(outcome.details)
    assert set(details["areas"]) == {"east", "west"}
    assert sum(time_s is not None for time_s in details["areas"].values()) == outcome.areas_explored > 0
    saved = [times for times in details["victims"].values() if times["saved_s"] is not None]
    assert len(saved) == outcome.victims_saved > 0
    assert all(0.0 <= times["heard_s"] <= times["saved_s"] <= outcome.time_s for times in saved)
    assert sum(robot["distance_m"] for robot in details["robots"]) == outcome.distance_m


def test_details_hold_victims_whom_the_schedule_adds():
    # A robot of the garage starts at (4, 5).
    changes = "schedule=[{at_s: 0, victim: eve, position: [4, 5]}, {at_s: 1, victim: pat, position: [56, 7]}]"
    outcome = run_trial(load("garage_sar", ["mission.time_limit_s=3", changes]), Trial(0, 1, 1), VERSION)
    victims = json.loads(outcome.details)["victims"]
    assert (outcome.error, list(victims)[4:], victims["eve"]["saved_s"]) == ("", ["eve", "pat"], 0.0)
    assert victims["pat"] == {"heard_s": None, "saved_s": None}


def test_failure_is_an_outcome_with_seed_and_traceback(hall_scenario, monkeypatch):
    def broken(scenario):
        raise ZeroDivisionError(f"seed {scenario.run.seed}\nis unlucky")

    monkeypatch.setattr(trial_module, "Simulation", broken)
    outcome = run_trial(hall_scenario(), Trial(2, 3, 13), VERSION)
    assert outcome.failed
    assert (outcome.cell, outcome.number, outcome.seed) == (2, 3, 13)
    assert re.fullmatch(r"ZeroDivisionError: seed 13 is unlucky \(test_one_trial\.py:\d+\)", outcome.error)
    assert "in broken\n" in outcome.traceback
    assert outcome.time_s is None


def test_worker_of_another_version_rejects(hall_scenario):
    with pytest.raises(CampaignError, match=f"^a worker has robotteamsim {VERSION}, expected 9.9$"):
        run_trial(hall_scenario(), Trial(0, 1, 1), "9.9")
