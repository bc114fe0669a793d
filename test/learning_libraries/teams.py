"""The teams that all libraries train: three robots in a garage, of which robot_1 leaves."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from robotteamsim.learning import Act, BatchEnv, DiscreteAct, TeamEnv, gym_env, parallel_env
from robotteamsim.scenario import Scenario, load

CASES = {"leaves during the mission": (1.0, 6), "leaves in the last step": (2.0, 4)}
"""When robot_1 leaves [s], and how many steps of 0.5 s a mission has."""

ACTS = (Act, DiscreteAct)


def _made(make: Callable[..., Any], case: str, act: type[Act], *arguments: Any) -> Any:
    at_s, cycles = CASES[case]
    garage: Scenario = load("garage_sar", [f"schedule=[{{at_s: {at_s}, remove: 1}}]"])
    return make(garage, *arguments, max_cycles=cycles, act=act)


def team(case: str, act: type[Act] = Act) -> TeamEnv:
    """Return PettingZoo's form."""
    return _made(parallel_env, case, act)


def central(case: str, act: type[Act] = Act) -> Any:
    """Return Gymnasium's form."""
    return _made(gym_env, case, act)


def batch(case: str, act: type[Act] = Act) -> BatchEnv:
    """Return two missions."""
    return _made(BatchEnv, case, act, 2)


def cases() -> list[tuple[str, type[Act]]]:
    """Return all cases."""
    return [(case, act) for case in CASES for act in ACTS]
