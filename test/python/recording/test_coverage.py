"""The floor that a team has covered: counted again, and where it is reported."""

from __future__ import annotations

import json

import numpy as np
import pytest

from robotteamsim.cli import main
from robotteamsim.recording.coverage import CoverageLog
from robotteamsim.recording.results import ResultWriter
from robotteamsim.scenario.sections import Coverage, Mission
from robotteamsim.simulation import Observer, Simulation


def scenario_of(hall_scenario, coverage, limit_s=30.0):
    mission = Mission(time_limit_s=limit_s, coverage=coverage)
    return hall_scenario(mission=mission, control={"algorithm": "random_walk"})


class Places(Observer):
    """An observer that keeps the true positions of each step."""

    def begin(self, setup):
        self.places = []

    def step(self, record):
        self.places.append(record.state.positions_m.copy())


def test_floor_within_the_radius_of_a_robot_is_covered(hall_scenario):
    log, seen = CoverageLog(), Places()
    Simulation(scenario_of(hall_scenario, Coverage(radius_m=1.5))).run([log, seen])
    x_m, y_m = np.meshgrid(np.arange(20) + 0.5, np.arange(10) + 0.5)
    covered = np.zeros((10, 20), bool)
    for positions_m in seen.places[4::5]:  # twice per second
        for x, y in positions_m:
            covered |= np.hypot(x_m - x, y_m - y) <= 1.5
    assert 0.1 < covered.mean() < 0.9
    assert log.share == pytest.approx(covered.mean(), abs=0.01)  # the last step is after the end


def test_mission_json_has_it_if_the_scenario_asks_for_it(hall_scenario, tmp_path):
    log = CoverageLog()
    Simulation(scenario_of(hall_scenario, Coverage())).run([log, ResultWriter(tmp_path / "with")])
    Simulation(scenario_of(hall_scenario, None, 1.0)).run([ResultWriter(tmp_path / "without")])
    found = [json.loads((tmp_path / name / "mission.json").read_text()) for name in ("with", "without")]
    assert found[0]["coverage"] == round(log.share, 4)
    assert "coverage" not in found[1]


def test_run_prints_it(capsys):
    command = ["run", "tutorial_arena", "--set", "mission.coverage={}", "--set", "mission.time_limit_s=5"]
    assert main([*command, "--json"]) == 0
    share = json.loads(capsys.readouterr().out)["coverage"]
    assert main(command) == 0
    assert f"floor covered {100.0 * share:.1f} %" in " ".join(capsys.readouterr().out.split())
    assert 0.0 < share < 1.0
