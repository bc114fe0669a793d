"""One trial as observers follow it, from its first step to its result."""

from __future__ import annotations

from collections.abc import Sequence

from robotteamsim.setup import Setup
from robotteamsim.simulation.record import Observer, Result, StepRecord
from robotteamsim.simulation.tally import Tally


class Trial:
    """Adds up the steps of a trial and reports each to the observers, until the mission has ended."""

    def __init__(self, setup: Setup, observers: Sequence[Observer]) -> None:
        """Begin. Raises: RecordingError: an observer cannot write; those that have begun have abandoned the trial."""
        self.result: Result | None = None
        """The result; None until the mission has ended."""
        self._tally = Tally(setup.scenario)
        self._observers: list[Observer] = []
        try:
            for observer in observers:
                self._observers.append(observer)
                observer.begin(setup)
        except BaseException:
            self.abandon()
            raise

    def add(self, record: StepRecord) -> None:
        """Add a step. Nothing changes after the end of the mission."""
        if self.result is not None:
            return
        self._tally.add(record)
        for observer in self._observers:
            observer.step(record)
        if record.mission.state == "ended":
            result = self._tally.result()
            while self._observers:
                self._observers[0].end(result)
                del self._observers[0]
            self.result = result

    def abandon(self) -> None:
        """Let the observers abandon an interrupted trial; no effect after the end of the mission."""
        while self._observers:
            self._observers.pop().abandon()
