"""Where the time of a step goes."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, NamedTuple, ParamSpec, TypeVar

Args = ParamSpec("Args")
Result = TypeVar("Result")

STAGES = {
    "schedule": ("schedule", "step"),
    "world": ("world", "step"),
    "hazards": ("hazards", "step"),
    "people": ("people", "step"),
    "sensors": ("sensors", "read"),
    "hearing": ("hearing", "step"),
    "network": ("network", "step"),
    "controllers": ("controllers", "step"),
    "mission": ("mission", "step"),
}
"""The stages of a step in their order: the part of `Simulation` and its method."""

STEP, REST, OBSERVERS = "step", "rest", "observers"


class StageTime(NamedTuple):
    """How long a stage took. share: of the time of all steps and their observers."""

    stage: str
    calls: int
    mean_s: float
    share: float


class StageTimes:
    """Adds up how long functions take, by the names of stages."""

    def __init__(self) -> None:
        self._calls: dict[str, int] = {}
        self._total_s: dict[str, float] = {}

    def of(self, stage: str, function: Callable[Args, Result]) -> Callable[Args, Result]:
        """Return the function, measured as a stage."""
        self._calls[stage], self._total_s[stage] = 0, 0.0

        def timed(*args: Args.args, **named: Args.kwargs) -> Result:
            begin_s = time.perf_counter()
            try:
                return function(*args, **named)
            finally:
                self._calls[stage] += 1
                self._total_s[stage] += time.perf_counter() - begin_s

        return timed

    def measure(self, simulation: Any) -> None:
        """Measure the stages of a simulation from now on."""
        for stage, (part, method) in STAGES.items():
            owner = getattr(simulation, part)
            setattr(owner, method, self.of(stage, getattr(owner, method)))
        simulation.step = self.of(STEP, simulation.step)

    def table(self) -> tuple[StageTime, ...]:
        """Return the stages in order, then what is left of a step, then the observers."""
        calls, total_s = self._calls, self._total_s.copy()
        rest_s = total_s[STEP] - sum(total_s[stage] for stage in STAGES)
        rows = [*((stage, calls[stage], total_s[stage]) for stage in STAGES), (REST, calls[STEP], rest_s)]
        if OBSERVERS in calls:
            rows.append((OBSERVERS, calls[OBSERVERS], total_s[OBSERVERS]))
        all_s = sum(seconds for *_, seconds in rows) or 1.0
        return tuple(
            StageTime(stage, count, seconds / max(count, 1), seconds / all_s) for stage, count, seconds in rows
        )
