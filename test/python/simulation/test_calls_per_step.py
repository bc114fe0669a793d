"""How many Python and C functions a step calls: unlike its time, the same on a loaded machine."""

from __future__ import annotations

import cProfile
import pstats
from collections.abc import Callable

import numpy as np
import pytest

from robotteamsim.learning import BatchEnv
from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation


def calls_of(do: Callable[[], object], times: int) -> float:
    """Return how many calls a call makes on average."""
    profile = cProfile.Profile()
    profile.enable()
    for _ in range(times):
        do()
    profile.disable()
    return pstats.Stats(profile).total_calls / times


@pytest.mark.slow
@pytest.mark.parametrize(("robots", "most_per_step"), [(3, 170), (100, 3_500)])
def test_step_of_the_garage_mission_makes_few_calls(robots, most_per_step):
    simulation = Simulation(load("garage_sar", [f"robots.count={robots}", "robots.spacing_m=0.45"]))
    simulation.mission.start()
    for _ in range(50):
        simulation.step()
    assert calls_of(simulation.step, 400) < most_per_step


@pytest.mark.slow
def test_step_of_a_batch_makes_few_calls_per_mission():
    env = BatchEnv("garage_sar", 32, every=1)
    actions = iter(np.random.default_rng(1).uniform(-1.0, 1.0, (60, 32, 3, 2)).astype(np.float32))
    env.reset(seed=1)
    env.step(next(actions))
    assert calls_of(lambda: env.step(next(actions)), 50) / 32 < 30
