"""The state of a mission."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, get_args

import msgspec

from robotteamsim.interface import Task

MissionState = Literal["waiting", "running", "paused", "ended"]
MissionEnd = Literal[
    "", "areas_explored", "victims_safe", "time_limit", "all_excluded", "none_left", "search_over", "aborted"
]
VictimState = Literal[
    "waiting", "heard", "saved", "located", "reported", "reached", "carried", "safe", "collapsed", "dead"
]
"""waiting, heard, saved if robots save; with firefighters, heard is followed by located to safe; safe also in exits."""

CALLING: frozenset[VictimState] = frozenset(("waiting", "heard"))
SILENT: frozenset[VictimState] = frozenset(get_args(VictimState)) - CALLING
"""States of victims who do not call: they cannot, or they know that help is coming."""
SAVED: frozenset[VictimState] = frozenset(("saved", "safe"))
OUT_OF_DANGER: frozenset[VictimState] = SAVED | {"dead"}
"""States that do not change any more."""
IN_CARE: frozenset[VictimState] = frozenset(("reached", "carried"))
"""States of victims whom a firefighter has reached."""
NOT_ALONE: frozenset[VictimState] = OUT_OF_DANGER | IN_CARE
"""States of victims who do not leave any more, or not without help."""

COMPLETED: frozenset[MissionEnd] = frozenset(("areas_explored", "victims_safe", "search_over"))
"""Ends of missions that were not cut short."""

END_TEXTS: Mapping[str, str] = {
    "areas_explored": "all areas are explored",
    "victims_safe": "all victims are safe or dead",
    "time_limit": "time limit reached",
    "all_excluded": "all robots are excluded",
    "none_left": "no robots left",
    "search_over": "the search is over",
    "aborted": "aborted",
}
"""Each MissionEnd as a text for users."""


class DeliveredDiscoveries(msgspec.Struct, frozen=True):
    """Totals of the discoveries delivered to the base.

    count: explored areas and reached victims.
    mean_delay_s, max_delay_s: from discovery to delivery [s]; 0 if there are none.
    """

    count: int = 0
    mean_delay_s: float = 0.0
    max_delay_s: float = 0.0

    def with_delay(self, delay_s: float) -> DeliveredDiscoveries:
        """Return the totals with one more discovery. Args: delay_s: from discovery to delivery [s]."""
        count = self.count + 1
        mean_s = self.mean_delay_s + (delay_s - self.mean_delay_s) / count
        return DeliveredDiscoveries(count, mean_s, max(self.max_delay_s, delay_s))


class MissionStatus(msgspec.Struct, frozen=True):
    """The mission after a step; time_s counts from its start.

    victims: state of each, in the scenario's order.  explored: whether each area is, in the scenario's order.
    target_area: index of the area to explore; -1 if none is left, or if each robot chooses its own.
    endangered_links: how often a link fell below the endangered threshold so far, lost or not.
    delivered: the discoveries delivered to the base; None if there is no base.
    """

    state: MissionState
    end: MissionEnd
    time_s: float
    explored: tuple[bool, ...]
    victims: tuple[VictimState, ...]
    target_area: int
    endangered_links: int
    task: Task
    delivered: DeliveredDiscoveries | None = None

    @property
    def areas_explored(self) -> int:
        """Number of explored areas."""
        return sum(self.explored)

    @property
    def victims_saved(self) -> int:
        """Number of victims who are saved or safe."""
        return sum(map(self.victims.count, SAVED))
