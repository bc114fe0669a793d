"""What missions report only if their scenario asks for it."""

from __future__ import annotations

from typing import Any

import msgspec

from robotteamsim.recording.coverage import CoverageLog
from robotteamsim.recording.idleness import Idleness, IdlenessLog, patrols
from robotteamsim.setup import Setup
from robotteamsim.simulation import Observer, Result, StepRecord


class Measured(msgspec.Struct, frozen=True, omit_defaults=True):
    """idleness: of a patrol.  coverage: share of the floor, 0 to 1.  None: the scenario does not ask for it."""

    idleness: Idleness | None = None
    coverage: float | None = None


class Measures(Observer):
    """An observer of idleness and coverage, if the scenario asks for them."""

    def __init__(self) -> None:
        self.measured = Measured()
        """The result, once the mission has ended."""

    def begin(self, setup: Setup) -> None:
        """Discard an earlier trial. Raises: ScenarioError: the plan has no room for a graph."""
        self.measured = Measured()
        self._idleness = IdlenessLog() if patrols(setup.scenario) else None
        self._coverage = None if setup.scenario.mission.coverage is None else CoverageLog()
        self._logs: list[Observer] = [log for log in (self._idleness, self._coverage) if log is not None]
        for log in self._logs:
            log.begin(setup)

    def step(self, record: StepRecord) -> None:
        """Process one step."""
        for log in self._logs:
            log.step(record)

    def end(self, result: Result) -> None:
        """Compute the result."""
        for log in self._logs:
            log.end(result)
        idleness = None if self._idleness is None else self._idleness.idleness
        self.measured = Measured(idleness, None if self._coverage is None else round(self._coverage.share, 4))

    def values(self) -> dict[str, Any]:
        """Return the result as plain values for JSON; empty before the end, and if there is none."""
        values: dict[str, Any] = msgspec.to_builtins(self.measured)
        return values
