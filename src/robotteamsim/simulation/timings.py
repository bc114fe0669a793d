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

SENSE, DECIDE, REST, OBSERVERS = "sense", "decide", "rest", "observers"
"""The halves of a step, what they take beside the stages, and those who get the record."""


class StageTime(NamedTuple):
    """How long a stage took. share: of the time of all steps and their observers."""

    stage: str
    calls: int
    mean_s: float
    share: float


class _TimedControllers:
    """Passes everything on."""

    def __init__(self, controllers: Any) -> None:
        self._controllers = controllers
        self.step = controllers.step

    def __getattr__(self, name: str) -> Any:
        return getattr(self._controllers, name)


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
        # A user's controllers may have no room for another attribute, or be those of several simulations.
        simulation.controllers = _TimedControllers(simulation.controllers)
        for stage, (part, method) in STAGES.items():
            owner = getattr(simulation, part)
            setattr(owner, method, self.of(stage, getattr(owner, method)))
        simulation.sense = self.of(SENSE, simulation.sense)
        simulation.decide = self.of(DECIDE, simulation.decide)

    def table(self) -> tuple[StageTime, ...]:
        """Return the stages in order, then what is left of a step, then the observers."""
        calls, total_s = self._calls, self._total_s.copy()
        rest_s = total_s[SENSE] + total_s[DECIDE] - sum(total_s[stage] for stage in STAGES)
        rows = [*((stage, calls[stage], total_s[stage]) for stage in STAGES), (REST, calls[DECIDE], rest_s)]
        if OBSERVERS in calls:
            rows.append((OBSERVERS, calls[OBSERVERS], total_s[OBSERVERS]))
        all_s = sum(seconds for *_, seconds in rows) or 1.0
        return tuple(
            StageTime(stage, count, seconds / max(count, 1), seconds / all_s) for stage, count, seconds in rows
        )
