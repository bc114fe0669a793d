"""Ctrl-C during a run."""

from __future__ import annotations

import signal
from types import FrameType

from robotteamsim.scenario.scenario import Scenario
from robotteamsim.simulation import Result, StepRecord


class InterruptBetweenSteps:
    """Lets Ctrl-C end a run after the step at hand, when all recorders have seen it whole; a second one ends it now."""

    def begin(self, scenario: Scenario) -> None:
        """Take over Ctrl-C."""
        self._wanted = False
        self._former = signal.signal(signal.SIGINT, self._note)

    def step(self, record: StepRecord) -> None:
        """End the run if that is wanted. Raises: KeyboardInterrupt."""
        if self._wanted:
            raise KeyboardInterrupt

    def end(self, result: Result) -> None:
        """Give Ctrl-C back."""
        signal.signal(signal.SIGINT, self._former)

    def abandon(self) -> None:
        """Give Ctrl-C back."""
        signal.signal(signal.SIGINT, self._former)

    def _note(self, signal_number: int, frame: FrameType | None) -> None:
        if self._wanted:
            raise KeyboardInterrupt
        self._wanted = True
