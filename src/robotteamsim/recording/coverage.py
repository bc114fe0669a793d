"""The floor that a team has covered."""

from __future__ import annotations

from robotteamsim.control.cover.floor_cover import FloorCover
from robotteamsim.setup import Setup
from robotteamsim.simulation import Observer, StepRecord

_LOOKS_HZ = 2.0
"""How often robots look around, at most."""


class CoverageLog(Observer):
    """An observer that measures which share of the floor robots have covered, by `mission.coverage`.

    It knows their true positions, twice per second while the mission runs. The floor is what can be reached from the
    start of the first robot; the base, relays and firefighters cover it, too.
    """

    def begin(self, setup: Setup) -> None:
        """Discard an earlier trial."""
        section = setup.scenario.mission.coverage
        assert section is not None, "mission.coverage: missing"
        self._cover = FloorCover(setup.building, setup.smallest_reach_m, setup.start_m(0), section.radius_m)
        self._every = max(round(1.0 / (_LOOKS_HZ * setup.scenario.run.step_s)), 1)

    def step(self, record: StepRecord) -> None:
        """Process one step."""
        if record.step_index % self._every == 0 and record.mission.state == "running":
            for position_m in record.state.positions_m[record.present].tolist():
                self._cover.look(tuple(position_m))

    @property
    def share(self) -> float:
        """The share that has been covered so far, 0 to 1."""
        return self._cover.share
