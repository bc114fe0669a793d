"""Missions with unusual keys, which the fuzz target `mission` has found: what the loader accepts runs."""

from __future__ import annotations

import pytest

from robotteamsim import load
from robotteamsim.simulation import Observer, Simulation, StepRecord

CENTRE = "command_centre=[1.5, 1.5]"
FIREFIGHTERS = (CENTRE, "mission.saved_by=firefighter", "firefighters.count=2")


class Faults(Observer):
    """The faults of all controllers."""

    def __init__(self) -> None:
        self.found: set[str] = set()

    def step(self, record: StepRecord) -> None:
        self.found |= {decision.fault for decision in record.decisions if decision.fault}


@pytest.mark.parametrize(
    "keys",
    [
        (*FIREFIGHTERS, "firefighters.start=[3, 3, 0]", "firefighters.dispatch.given_up_s=0.13"),
        (CENTRE, "control.algorithm=boustrophedon"),
    ],
    ids=["given up before contact is lost", "centre that is no robot"],
)
def test_mission_runs_without_a_fault_of_a_controller(keys):
    faults = Faults()
    Simulation(load("tutorial_arena", ["mission.time_limit_s=2", *keys])).run([faults])
    assert faults.found == set()
