"""What is known of a mission: its state, its events, what it asks of the team."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

from robotteamsim.interface import Task

MissionState = Literal["waiting", "running", "paused", "ended"]
MissionEnd = Literal["", "areas_explored", "time_limit", "all_excluded", "none_left", "aborted"]
VictimState = Literal["waiting", "heard", "saved"]


@dataclass(frozen=True, slots=True)
class Event:
    """Something that happened.

    kind:     start, pause, resume, end, area_explored, victim_heard, victim_saved, link_endangered, robot_excluded,
              robot_included, robot_removed, robot_spawned, swarm_founded, swarm_dissolved, controller_failed,
              message_too_large,
              find_reported (the base has heard of an area explored or a victim reached, by robot_id),
              door (opened or closed), door_moves (its leaf sets off, is held up or arrives), noise, ...
    subject:  name of the area, victim, door, link ("0-2") or swarm ("swarm 1") it happened to; "" for the mission.
    robot_id: who did it; -1 for nobody.
    detail:   one readable line.
    """

    time_s: float
    kind: str
    subject: str
    robot_id: int
    detail: str


class Reports(NamedTuple):
    """What the base has heard of.

    reported: areas explored and victims reached that it has heard of.
    mean_delay_s, max_delay_s: from finding to hearing, of those [s]; 0 where there are none.
    """

    reported: int = 0
    mean_delay_s: float = 0.0
    max_delay_s: float = 0.0

    def with_delay(self, delay_s: float) -> Reports:
        """Return the same with one more report that took so long [s]."""
        count = self.reported + 1
        mean_s = self.mean_delay_s + (delay_s - self.mean_delay_s) / count
        return Reports(count, mean_s, max(self.max_delay_s, delay_s))


class MissionStatus(NamedTuple):
    """The mission after a step; time_s counts from its start.

    victims: state of each, in the scenario's order.  explored: whether each area is, in the scenario's order.
    target_area: index of the area to explore; -1 when none is left.
    endangered_links: times a link became endangered so far.
    reports: what the base has heard of; None: there is no base.
    """

    state: MissionState
    end: MissionEnd
    time_s: float
    explored: tuple[bool, ...]
    victims: tuple[VictimState, ...]
    target_area: int
    endangered_links: int
    task: Task
    reports: Reports | None = None

    def at(self, time_s: float) -> MissionStatus:
        """Return the same at another time of the mission's clock [s]."""
        return self._replace(time_s=time_s)

    @property
    def areas_explored(self) -> int:
        """Number of explored areas."""
        return sum(self.explored)

    @property
    def victims_saved(self) -> int:
        """Number of saved victims."""
        return sum(state == "saved" for state in self.victims)
