"""What a mission judges in one step."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

import msgspec
import numpy as np

from robotteamsim.hazards import HazardField, Ignited
from robotteamsim.interface import Decision
from robotteamsim.network.messages import Message, NetworkState
from robotteamsim.scenario.base import Point
from robotteamsim.sensing.readings import VoiceReading
from robotteamsim.world.contract import Mishap
from robotteamsim.world.doors import DoorStates
from robotteamsim.world.people import PersonState


class MissionInput(msgspec.Struct, frozen=True, kw_only=True, eq=False):
    """The state of one step, after the controllers have decided. Sequences are in robot id order.

    positions_m: true positions of the team in `map`, shape (n, 2) [m].
    speaker:     name of the victim whose voice is the loudest at a place in `map` [m]; None if nobody calls.
    present:     whether each robot is present, bool, shape (n,). Absent robots do not count.
    team_version: increases with each change of `present`.
    failed:      ids of the absent members who have failed by heat or collapsed.
    base_inbox:  messages that the base receives, if there is a base.
    doors:       after the step; empty if unknown.
    moved:       new positions of people who have moved, by name, in `map` [m].
    people:      that the world moves.
    smoke:       fire, smoke and temperature as of their last update; None if nothing can burn.
    harms:       whether that update was in this step.
    ignited, burnt_doors: what has begun to burn, and the doors that have burnt through, so far.
    mishaps, loads: why robots cannot go on, and what they hold, by id.
    """

    sim_time_ns: int
    positions_m: np.ndarray
    voices: Sequence[VoiceReading]
    speaker: Callable[[Point], str | None]
    network: NetworkState
    decisions: Sequence[Decision]
    present: np.ndarray
    team_version: int = 0
    failed: frozenset[int] = frozenset()
    base_inbox: Sequence[Message] = ()
    doors: DoorStates = DoorStates()
    moved: Mapping[str, Point] = MappingProxyType({})
    people: tuple[PersonState, ...] = ()
    smoke: HazardField | None = None
    harms: bool = False
    ignited: tuple[Ignited, ...] = ()
    burnt_doors: tuple[str, ...] = ()
    mishaps: Mapping[int, Mishap] = MappingProxyType({})
    loads: Mapping[int, str] = MappingProxyType({})

    @property
    def enclosed(self) -> frozenset[str]:
        """The names of people to whom no path to an exit is open."""
        return frozenset(person.name for person in self.people if person.motion == "enclosed")
