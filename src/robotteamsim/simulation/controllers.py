"""The stage in which the team decides: the controllers of the scenario, or others in their place."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Protocol

import msgspec
import numpy as np

from robotteamsim.control import Guard, make_controller
from robotteamsim.errors import ScenarioError
from robotteamsim.interface import Controller, Decision, Observation, Task
from robotteamsim.network.messages import Message
from robotteamsim.scenario import Scenario
from robotteamsim.sensing.readings import TeamReadings, VoiceReading
from robotteamsim.setup import Setup


class TeamInputs(msgspec.Struct, frozen=True, eq=False):
    """The inputs of all controllers in one step; sequences are in robot id order.

    inboxes:  messages that arrived in this step.   task: of the mission, as of the step before.
    present:  whether each robot is present, bool, shape (n,). Entries of absent robots mean nothing.
    arrivals: how often each robot has arrived, its start included.
    """

    sim_time_ns: int
    readings: TeamReadings
    voices: tuple[VoiceReading, ...]
    inboxes: Sequence[Sequence[Message]]
    task: Task
    present: np.ndarray
    arrivals: Sequence[int]

    def observations(self) -> list[Observation]:
        """Return what each member of the team perceives."""
        team = zip(self.readings.robots, self.voices, strict=True)
        return [Observation(i, self.sim_time_ns, reading, voice) for i, (reading, voice) in enumerate(team)]


class Controllers(Protocol):
    """What decides for the team: the controllers in this process, or a shell to controllers elsewhere."""

    @property
    def faults(self) -> Sequence[str]:
        """Why each controller was stopped, or could not be made; "" while it works."""

    def step(self, inputs: TeamInputs) -> tuple[Decision, ...]:
        """Return the decision of each robot in id order; `Decision()` for an absent one."""


def decisions_of(controllers: Sequence[Controller], inputs: TeamInputs) -> tuple[Decision, ...]:
    """Return the decision of each controller in id order; `Decision()` for an absent robot."""
    team = zip(controllers, inputs.observations(), inputs.inboxes, inputs.present.tolist(), strict=True)
    return tuple(
        controller.step(observation, inbox, inputs.task) if is_present else Decision()
        for controller, observation, inbox, is_present in team
    )


def check_constructed(controllers: Controllers, scenario: Scenario) -> None:
    """Raises: ScenarioError: a controller could not be constructed, so that its robot would stand still."""
    for robot_id, fault in enumerate(controllers.faults):
        if fault:
            raise ScenarioError(
                f"{scenario.name}: control.algorithm: '{scenario.control.algorithm}' cannot be constructed for robot "
                f"{robot_id}: {fault}"
            )


class TeamControllers:
    """The controllers of a scenario, in this process. A robot that arrives starts with a new one."""

    def __init__(self, setup: Setup) -> None:
        """Make the controllers. Raises: RobotTeamSimError: the user's mistake, such as an unknown controller."""
        self._setup = setup
        self._arrivals: Sequence[int] = (1,) * len(setup.robots)
        self.guards = [self._guard(robot_id, 1) for robot_id in range(len(setup.robots))]
        """The controllers in robot id order."""

    @property
    def faults(self) -> Sequence[str]:
        """As for all controllers."""
        return [guard.fault for guard in self.guards]

    def step(self, inputs: TeamInputs) -> tuple[Decision, ...]:
        """As for all controllers."""
        if inputs.arrivals != self._arrivals:
            self._make_arrived(inputs.arrivals)
        return decisions_of(self.guards, inputs)

    def _make_arrived(self, arrivals: Sequence[int]) -> None:
        for robot_id, (before, count) in enumerate(zip(self._arrivals, arrivals, strict=True)):
            if count > before:
                self.guards[robot_id] = self._guard(robot_id, count)
        self._arrivals = arrivals

    def _guard(self, robot_id: int, arrival: int) -> Guard:
        return Guard(robot_id, len(self._setup.robots), partial(make_controller, robot_id, self._setup, arrival))
