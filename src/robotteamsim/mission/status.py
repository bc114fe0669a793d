"""The state of a mission and its events."""

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
"""waiting, heard, saved if robots save; with firefighters, heard is followed by located to safe."""

CALLING: frozenset[VictimState] = frozenset(("waiting", "heard"))
SILENT: frozenset[VictimState] = frozenset(get_args(VictimState)) - CALLING
"""States of victims who do not call: they cannot, or somebody has told them that help is on its way."""
SAVED: frozenset[VictimState] = frozenset(("saved", "safe"))
OUT_OF_DANGER: frozenset[VictimState] = SAVED | {"dead"}
"""States that do not change any more."""

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


class Event(msgspec.Struct, frozen=True, gc=False):
    """An event of a mission.

    kind:     start, pause, resume, end, area_explored, victim_heard, victim_saved, victim_located,
              victim_reported, victim_reached, victim_carried, victim_safe, victim_left (by a firefighter
              who left the team), person_enclosed, link_endangered, robot_excluded,
              robot_included, robot_removed, robot_spawned, robot_tipped_over, robot_left_world,
              object_lifted, object_dropped,
              swarm_founded, swarm_dissolved, controller_failed,
              message_too_large,
              robot_failed_by_heat, firefighter_collapsed, victim_collapsed, victim_dead,
              discovery_delivered (the discovery of an area or victim by robot_id was delivered to the base),
              door (opened or closed), door_moves (its leaf starts, is blocked or stops), noise, ...
    subject:  name of the area, victim, door, link ("0-2") or swarm ("swarm 1"); "" for the mission itself.
    robot_id: id of the robot that caused it; -1 if none did.
    detail:   a description in one line.
    """

    time_s: float
    kind: str
    subject: str
    robot_id: int
    detail: str


class DeliveredDiscoveries(msgspec.Struct, frozen=True, gc=False):
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


class MissionStatus(msgspec.Struct, frozen=True, gc=False):
    """The mission after a step; time_s counts from its start.

    victims: state of each, in the scenario's order.  explored: whether each area is, in the scenario's order.
    target_area: index of the area to explore; -1 if none is left.
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
        return sum(state in SAVED for state in self.victims)
