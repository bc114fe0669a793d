"""Ctrl-C during a run."""

import signal
from types import FrameType

from robotteamsim.scenario.scenario import Scenario
from robotteamsim.simulation import Result, StepRecord


class InterruptBetweenSteps:
    """Ends a run on Ctrl-C after the current step has been recorded; a second Ctrl-C ends it at once."""

    def begin(self, scenario: Scenario) -> None:
        """Install the handler."""
        self._pressed = False
        self._previous = signal.signal(signal.SIGINT, self._note)

    def step(self, record: StepRecord) -> None:
        """End the run if Ctrl-C was pressed. Raises: KeyboardInterrupt."""
        if self._pressed:
            raise KeyboardInterrupt

    def end(self, result: Result) -> None:
        """Restore the previous handler."""
        signal.signal(signal.SIGINT, self._previous)

    def abandon(self) -> None:
        """Restore the previous handler."""
        signal.signal(signal.SIGINT, self._previous)

    def _note(self, signal_number: int, frame: FrameType | None) -> None:
        if self._pressed:
            raise KeyboardInterrupt
        self._pressed = True
