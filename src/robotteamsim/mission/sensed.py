"""What a step knows before anybody decides."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from types import MappingProxyType

import msgspec
import numpy as np

from robotteamsim import _core
from robotteamsim.hazards import HazardField, Ignited
from robotteamsim.interface import Observation, Task
from robotteamsim.network.messages import Message, NetworkState
from robotteamsim.propagation import FieldMap
from robotteamsim.scenario.base import Point
from robotteamsim.sensing.readings import RobotReading, VoiceReading
from robotteamsim.world.contract import NO_OBJECTS, Mishap, ObjectStates
from robotteamsim.world.doors import DoorStates
from robotteamsim.world.people import PersonState


class Sensed(msgspec.Struct, kw_only=True, eq=False, dict=True):
    """The part of a step that controllers and mission start from; sequences are in robot id order.

    step_index: 1 for the first step.     sim_time_ns: its stamp [ns].
    state:      what moved and what was measured and heard, as named arrays, see `docs/python.md`.
    inboxes:    messages that arrived in this step, sent in the one before.
    task:       of the mission, as of the step before.
    voice_map:  the voice level over the floor [dB] in the first step and whenever it has changed, else None.
    doors:      after the step, by name, in the plan's order; empty if unknown.
    team_version: increases with each change of present, arrivals, mishaps and loads.
    present:    whether each robot is present, bool, shape (n,). Entries of absent robots mean nothing.
    arrivals:   how often each robot has arrived, its start included.
    mishaps:    robots that cannot go on, by id, and why.
    loads:      names of the objects that robots hold, by the robots' ids.
    objects:    the boxes and barrels, and where they are.
    smoke:      fire, smoke and temperature as of their last update; None if nothing can burn.
    smoke_is_new: whether that update was in this step.
    failed:     ids of the absent robots that have failed by heat, and of the firefighters who have collapsed.
    ignited, burnt_doors: what has begun to burn, and the doors that have burnt through, so far.
    moved:      new positions of people who have moved, by name, in `map` [m].
    people:     that the world moves; `people_version` increases with each update of their positions.
    """

    step_index: int
    sim_time_ns: int
    state: _core.state.State
    network: NetworkState
    inboxes: Sequence[Sequence[Message]]
    task: Task = Task()
    voice_map: FieldMap | None = None
    doors: DoorStates = DoorStates()
    team_version: int = 0
    present: np.ndarray
    arrivals: tuple[int, ...] = ()
    mishaps: Mapping[int, Mishap] = MappingProxyType({})
    loads: Mapping[int, str] = MappingProxyType({})
    objects: ObjectStates = NO_OBJECTS
    smoke: HazardField | None = None
    smoke_is_new: bool = False
    failed: frozenset[int] = frozenset()
    ignited: tuple[Ignited, ...] = ()
    burnt_doors: tuple[str, ...] = ()
    moved: Mapping[str, Point] = MappingProxyType({})
    people: tuple[PersonState, ...] = ()
    people_version: int = 0

    @cached_property
    def readings(self) -> Sequence[RobotReading]:
        """What each robot measures."""
        return self.state.readings()

    @cached_property
    def voices(self) -> Sequence[VoiceReading]:
        """What each robot hears."""
        return self.state.voices()

    @property
    def hazards(self) -> HazardField | None:
        """Fire, smoke and temperature, in the steps in which they advance, else None."""
        return self.smoke if self.smoke_is_new else None

    @property
    def enclosed(self) -> frozenset[str]:
        """The names of people to whom no path to an exit is open."""
        return frozenset(person.name for person in self.people if person.motion == "enclosed")

    def is_there(self, robot_id: int) -> bool:
        """Whether a robot is present."""
        return bool(self.present[robot_id])

    def observation(self, robot_id: int) -> Observation:
        """Return what a member of the team perceives."""
        state, made = self.state, self.__dict__
        reading = made["readings"][robot_id] if "readings" in made else state[robot_id]
        voice = made["voices"][robot_id] if "voices" in made else state.voice_of(robot_id)
        return Observation(robot_id, self.sim_time_ns, reading, voice)

    def observations(self) -> list[Observation]:
        """Return what each member of the team perceives."""
        team = zip(self.readings, self.voices, strict=True)
        return [Observation(i, self.sim_time_ns, reading, voice) for i, (reading, voice) in enumerate(team)]
