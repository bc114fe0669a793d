"""The record of each step, the result of a trial, and the observers of both."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Protocol

import msgspec
import numpy as np

from robotteamsim.hazards import HazardField
from robotteamsim.interface import Decision
from robotteamsim.mission.egress import Egress
from robotteamsim.mission.events import Event
from robotteamsim.mission.status import MissionEnd, MissionStatus
from robotteamsim.network.messages import Message, NetworkState
from robotteamsim.propagation import FieldMap
from robotteamsim.scenario.sections import Victim
from robotteamsim.sensing.readings import TeamReadings, VoiceReading
from robotteamsim.setup import Setup
from robotteamsim.world.contract import Mishap
from robotteamsim.world.doors import DoorStates
from robotteamsim.world.people import PersonState


class StepRecord(msgspec.Struct, frozen=True, kw_only=True, eq=False):
    """The record of one step; sequences are in robot id order.

    A step has one stamp, the time of the world at its end: step k of length T has the stamp k T. All that happens in it
    happens at this stamp, changes by a schedule included. The mission's clock, `mission.time_s`, is 0 at the stamp of
    the step in which the mission starts, and stops while the mission is paused. In a mission that starts with the first
    step, it is the time at which the step begins, so a change that is scheduled at 20 s happens at 20 s. ROS messages,
    bags and trajectories have stamps; all that shows a mission to people (terminal, mission.json, reports, views,
    films) has the mission's clock, in bags the time since the stamp at which it is 0.

    step_index: 1 for the first step.     sim_time_ns: its stamp [ns].
    inboxes:    messages that arrived in this step, sent in the one before.
    decisions:  of the controllers; their outboxes arrive in the next step.
    victims:    in the order of `mission.victims`, at their current positions.
    doors:      after the step, by name, in the plan's order.
    team_version: increases with each change of present, arrivals, mishaps and loads.
    present:    whether each robot is present, bool, shape (n,). Entries of absent robots mean nothing.
    arrivals:   how often each robot has arrived, its start included.
    mishaps:    robots that cannot go on, by id, and why.
    loads:      names of the objects that robots hold, by the robots' ids.
    voice_map:  the voice level over the floor [dB] in the first step and whenever it has changed, else None.
    hazards:    fire, smoke and temperature, in the steps in which they advance, else None.
    failed:     ids of the absent robots that have failed by heat.
    people:     that the world moves; `people_version` increases with each update of their positions.
    egress:     how people leave; None without fire and without exits.
    """

    step_index: int
    sim_time_ns: int
    readings: TeamReadings
    voices: tuple[VoiceReading, ...]
    network: NetworkState
    inboxes: Sequence[Sequence[Message]]
    decisions: tuple[Decision, ...]
    mission: MissionStatus
    events: tuple[Event, ...]
    victims: tuple[Victim, ...]
    noise_db: float
    voice_map: FieldMap | None
    doors: DoorStates = DoorStates()
    team_version: int = 0
    present: np.ndarray
    arrivals: tuple[int, ...] = ()
    mishaps: Mapping[int, Mishap] = MappingProxyType({})
    loads: Mapping[int, str] = MappingProxyType({})
    hazards: HazardField | None = None
    failed: frozenset[int] = frozenset()
    people_version: int = 0
    people: tuple[PersonState, ...] = ()
    egress: Egress | None = None

    def is_there(self, robot_id: int) -> bool:
        """Whether a robot is present."""
        return bool(self.present[robot_id])

    @property
    def sim_time_s(self) -> float:
        """Stamp of the step [s]."""
        return self.sim_time_ns / 1e9

    def __repr__(self) -> str:
        mission = self.mission
        saved = f"{mission.victims_saved} of {len(self.victims)} victims saved"
        areas = f"{mission.areas_explored} of {len(mission.explored)} areas explored"
        return f"<StepRecord {self.step_index}: {self.sim_time_s:g} s, {mission.state}, {areas}, {saved}>"


class RobotTotals(msgspec.Struct, frozen=True):
    """Totals of one robot over a trial.

    distance_m: length of its true path.      contact_s: time in which it touched something.
    excluded_s: time as an excluded robot.    longest_stay_s: longest time within 0.5 m of one place.
    """

    distance_m: float
    contact_s: float
    excluded_s: float
    longest_stay_s: float


class Result(msgspec.Struct, frozen=True):
    """The outcome of a trial.

    time_s: of the mission's clock, see `StepRecord`.     sim_time_s: stamp of the last step [s].
    wall_s: of the computation, the only value that differs between equal runs.
    discoveries_delivered: discoveries delivered to the base; None: there is no base.
    mean_delivery_delay_s, max_delivery_delay_s: from discovery to delivery [s]; None: none was delivered.
    egress: how people left; None without fire and without exits.
    """

    scenario: str
    seed: int
    noise_db: float
    end: MissionEnd
    time_s: float
    areas_explored: int
    num_areas: int
    victims_saved: int
    num_victims: int
    endangered_links: int
    trajectory_hash: str
    steps: int
    sim_time_s: float
    robots: tuple[RobotTotals, ...]
    wall_s: float
    discoveries_delivered: int | None = None
    mean_delivery_delay_s: float | None = None
    max_delivery_delay_s: float | None = None
    victims_dead: int = 0
    egress: Egress | None = None

    @property
    def speed(self) -> float:
        """Simulated time over wall time."""
        return self.sim_time_s / self.wall_s if self.wall_s > 0 else float("inf")


class Observer(Protocol):
    """Receives each step of a trial: a recorder, a progress bar. After `begin`, `end` or `abandon` is called once.

    A class below this one need not define what it ignores.
    """

    def begin(self, setup: Setup) -> None:
        """A trial begins."""
        return

    def step(self, record: StepRecord) -> None:
        """A step is complete."""
        return

    def end(self, result: Result) -> None:
        """The mission has ended."""
        return

    def abandon(self) -> None:
        """The trial was interrupted: close files and leave nothing half-written. Must not raise."""
        return
