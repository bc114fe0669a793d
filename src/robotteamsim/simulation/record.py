"""The record of each step, the result of a trial, and the observers of both."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import msgspec

from robotteamsim.interface import Decision
from robotteamsim.mission.egress import Egress
from robotteamsim.mission.events import Event
from robotteamsim.mission.sensed import Sensed
from robotteamsim.mission.status import MissionEnd, MissionStatus
from robotteamsim.scenario.sections import Victim
from robotteamsim.setup import Setup


class StepRecord(Sensed, kw_only=True, eq=False):
    """The record of one step: what `Sensed` lists, what the team decided, and what the mission made of it.

    A step has one stamp, the time of the world at its end: step k of length T has the stamp k T. All that happens in it
    happens at this stamp, changes by a schedule included. The mission's clock, `mission.time_s`, is 0 at the stamp of
    the step in which the mission starts, and stops while the mission is paused. In a mission that starts with the first
    step, it is the time at which the step begins, so a change that is scheduled at 20 s happens at 20 s. ROS messages,
    bags and trajectories have stamps; all that shows a mission to people (terminal, mission.json, reports, views,
    films) has the mission's clock, in bags the time since the stamp at which it is 0.

    decisions:  of the controllers; their outboxes arrive in the next step.
    mission, events: after the step, and what has happened since the last one.
    victims:    in the order of `mission.victims`, at their current positions.
    noise_db:   the background noise.
    egress:     how people leave; None without fire and without exits.
    """

    decisions: Sequence[Decision]
    mission: MissionStatus
    events: tuple[Event, ...]
    victims: tuple[Victim, ...]
    noise_db: float
    egress: Egress | None = None

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

    distance_m: length of its true path, without jumps between levels and by `set_pose`.
    contact_s:  time in which it touched something.
    excluded_s: time as an excluded robot.
    longest_stay_s: longest time within 0.5 m of one place.
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
