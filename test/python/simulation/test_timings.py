"""Where the time of a step goes."""

from __future__ import annotations

import json
import time

import pytest

from robotteamsim.cli import main
from robotteamsim.interface import Decision
from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation
from robotteamsim.simulation.timings import OBSERVERS, REST, STAGES

SHORT = ["mission.time_limit_s=3"]


class Slow:
    """An observer that takes a millisecond."""

    def begin(self, setup): ...

    def step(self, record):
        time.sleep(0.001)

    def end(self, result): ...

    def abandon(self): ...


def test_each_stage_is_called_once_a_step_and_the_shares_are_a_whole():
    simulation = Simulation(load("garage_sar", SHORT))
    simulation.time_stages()
    result = simulation.run([Slow()])
    timings = {time.stage: time for time in simulation.timings()}
    assert list(timings) == [*STAGES, REST, OBSERVERS]
    assert {time.calls for time in timings.values()} == {result.steps}
    assert sum(time.share for time in timings.values()) == pytest.approx(1.0)
    assert timings[OBSERVERS].mean_s > 0.001
    assert all(time.mean_s > 0.0 for time in timings.values())


class Narrow:
    """Controllers that have no room for another attribute."""

    __slots__ = ("faults",)

    def __init__(self):
        self.faults = ("",) * 3

    def step(self, sensed):
        return (Decision(),) * 3


def test_halves_of_a_step_are_measured_too_and_controllers_of_any_kind():
    simulation = Simulation(load("garage_sar", SHORT), controllers=Narrow())
    simulation.time_stages()
    for _ in range(5):
        simulation.decide(simulation.sense())
    assert simulation.controllers.faults == ("",) * 3
    assert {(time.calls, time.mean_s > 0.0) for time in simulation.timings()} == {(5, True)}


def test_measured_mission_has_the_same_bits():
    measured = Simulation(load("garage_sar", SHORT))
    measured.time_stages()
    assert measured.run().trajectory_hash == Simulation(load("garage_sar", SHORT)).run().trajectory_hash


def test_timings_that_were_not_measured_are_one_line():
    with pytest.raises(ValueError, match=r"^timings: nothing was measured; call time_stages\(\) before the steps$"):
        Simulation(load("garage_sar", SHORT)).timings()


def test_run_prints_a_row_for_each_stage(capsys):
    command = ["run", "garage_sar", "--set", *SHORT, "--timings"]
    assert main(command) == 0
    out = capsys.readouterr().out
    assert "where the time went" in out
    assert all(stage in out for stage in (*STAGES, REST, OBSERVERS))
    assert main([*command, "--json"]) == 0
    timings = json.loads(capsys.readouterr().out)["timings"]
    assert [one["stage"] for one in timings] == [*STAGES, REST, OBSERVERS]
