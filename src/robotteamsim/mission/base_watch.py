"""What the base has heard of what the robots found, told from the messages that reach it."""

from __future__ import annotations

from collections.abc import Sequence

from robotteamsim.control.runtime.base_station import tells_of
from robotteamsim.interface import Discovery
from robotteamsim.mission.status import Reports
from robotteamsim.network.messages import Message
from robotteamsim.scenario.scenario import Scenario


class BaseWatch:
    """Keeps discoveries until a message that tells of them has reached the base; without a base it keeps nothing."""

    def __init__(self, scenario: Scenario) -> None:
        self.base = scenario.mission.base
        self.unreported: tuple[Discovery, ...] = ()
        """What the base has not heard of, in the order of finding; the same object until that changes."""
        self.reports = None if self.base is None else Reports()
        # As far as a robot that covers the floor can be wrong about where a victim is.
        self._within_m = scenario.mission.save_distance_m + scenario.voice.map_resolution_m

    def add(self, find: Discovery) -> None:
        """Take note of a discovery; one of the same kind and name counts as found anew."""
        if self.base is not None:
            others = [old for old in self.unreported if (old.kind, old.name) != (find.kind, find.name)]
            self.unreported = (*others, find)

    def heard_of(self, inbox: Sequence[Message], time_s: float) -> list[Discovery]:
        """Return what the base hears of now: what is in its inbox, and what it found itself.

        Args: time_s: of the mission's clock [s].
        """
        if self.reports is None or not self.unreported:
            return []
        heard = [
            find
            for find in self.unreported
            if find.robot_id == self.base or any(tells_of(message.payload, find, self._within_m) for message in inbox)
        ]
        if heard:
            self.unreported = tuple(find for find in self.unreported if find not in heard)
            for find in heard:
                self.reports = self.reports.with_delay(time_s - find.time_s)
        return heard
