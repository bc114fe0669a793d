"""The tasks: a scenario, what agents perceive in it, and what they are rewarded for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import gymnasium

from robotteamsim.learning.errors import LearningError
from robotteamsim.learning.found_floor import FoundMemory
from robotteamsim.learning.gym_env import CentralEnv, gym_env
from robotteamsim.learning.memory import FloorMemory, PatrolMemory, RescueMemory
from robotteamsim.learning.observe import Observe
from robotteamsim.learning.reward import (
    ConnectedCoverageReward,
    CoverageReward,
    KnownFloorReward,
    PatrolReward,
    RescueReward,
    Reward,
    SearchReward,
)
from robotteamsim.learning.rules import AnyScenario
from robotteamsim.scenario import Scenario, load


class FloorObserve(Observe):
    """Also the floor that an agent knows to be covered, and a place to cover next."""

    remembers = FloorMemory


class FoundObserve(Observe):
    """Also the map that an agent has found of a building that nobody knows, and a path to where it ends."""

    remembers = FoundMemory


class PatrolObserve(Observe):
    """Also the vertices near an agent, and their idleness as far as it knows."""

    remembers = PatrolMemory


class RescueObserve(Observe):
    """Also covered floor, as of `FloorObserve`, and what a thermal camera shows."""

    remembers = RescueMemory


class LearningTask(NamedTuple):
    """A shipped scenario, and rules. Args: changes: of the scenario, also of another one that is given by name."""

    scenario: str
    reward: type[Reward] = SearchReward
    observe: type[Observe] = Observe
    changes: tuple[str, ...] = ()


_NO_SEARCH = ("mission.areas=[]", "mission.victims=[]")
_COVERAGE = (*_NO_SEARCH, "mission.coverage={}")
# From one start, a controller without chance would drive the same mission with every seed.
_ANYWHERE = ("robots.formation=random",)

TASKS: Mapping[str, LearningTask] = {
    "garage_search": LearningTask("garage_sar"),
    "floor_search": LearningTask("isr_floor_0_sar"),
    "explore": LearningTask("garage_sar", CoverageReward, FloorObserve, (*_COVERAGE, *_ANYWHERE)),
    "explore_unknown": LearningTask("garage_unknown", KnownFloorReward, FoundObserve, (*_NO_SEARCH, *_ANYWHERE)),
    "connected_coverage": LearningTask(
        "office_manet", ConnectedCoverageReward, FloorObserve, (*_COVERAGE, "mission.base=null")
    ),
    "patrol": LearningTask("garage_sar", PatrolReward, PatrolObserve, (*_NO_SEARCH, *_ANYWHERE)),
    "rescue": LearningTask("garage_fire", RescueReward, RescueObserve, ("mission.areas=[]",)),
}
"""By name. A task that is added is a line here; it is then also an environment of Gymnasium."""


def task(name: str, scenario: AnyScenario | None = None, overrides: Sequence[str] = ()) -> dict[str, Any]:
    """Return scenario, `observe` and `reward` of a task, for `parallel_env(**task("explore"))`, `BatchEnv`, `gym_env`.

    Args:   scenario: another one: a file or shipped name, to which the task's changes apply; or a `Scenario`, as it is.
            overrides: of keys of the scenario, as of `scenario.load`.
    Raises: RobotTeamSimError: one line: there is no such task, or the scenario is invalid.
    """
    if name not in TASKS:
        raise LearningError(f"there is no task {name!r:.60}; expected one of {', '.join(TASKS)}")
    if isinstance(overrides, str):
        raise LearningError(f"overrides: {overrides!r:.60}; expected a list of key=value")
    chosen = TASKS[name]
    if isinstance(scenario, Scenario):
        if overrides:
            raise LearningError(f"overrides: {overrides!r:.60}; expected none with a scenario that is loaded")
        loaded = scenario
    else:
        loaded = load(chosen.scenario if scenario is None else scenario, [*chosen.changes, *overrides])
    return {"scenario": loaded, "observe": chosen.observe, "reward": chosen.reward}


def gym_task(
    name: str, scenario: AnyScenario | None = None, overrides: Sequence[str] = (), **settings: Any
) -> CentralEnv:
    """Return a task as an environment of Gymnasium. Args: see `task` and `parallel_env`."""
    return gym_env(**(task(name, scenario, overrides) | settings))


def register() -> None:
    """Register the tasks with Gymnasium, for `gymnasium.make("robotteamsim/GarageSearch-v0")`."""
    for name in TASKS:
        title = name.title().replace("_", "")
        gymnasium.register(f"robotteamsim/{title}-v0", f"{__name__}:gym_task", kwargs={"name": name})
