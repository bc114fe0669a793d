"""The stage in which the team decides: the controllers of the scenario, or others in their place."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Protocol

from robotteamsim.control import Guard, make_controller
from robotteamsim.errors import ScenarioError
from robotteamsim.interface import Controller, Decision
from robotteamsim.mission.sensed import Sensed
from robotteamsim.scenario import Scenario
from robotteamsim.setup import Setup


class Controllers(Protocol):
    """What decides for the team: the controllers in this process, or a shell to controllers elsewhere."""

    @property
    def faults(self) -> Sequence[str]:
        """Why each controller was stopped, or could not be made; "" while it works."""

    def step(self, sensed: Sensed) -> tuple[Decision, ...]:
        """Return the decision of each robot in id order; `Decision()` for an absent one."""


def decisions_of(controllers: Sequence[Controller], sensed: Sensed) -> tuple[Decision, ...]:
    """Return the decision of each controller in id order; `Decision()` for an absent robot."""
    team = zip(controllers, sensed.observations(), sensed.inboxes, sensed.present.tolist(), strict=True)
    return tuple(
        controller.step(observation, inbox, sensed.task) if is_present else Decision()
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

    def step(self, sensed: Sensed) -> tuple[Decision, ...]:
        """As for all controllers."""
        if sensed.arrivals != self._arrivals:
            self._make_arrived(sensed.arrivals)
        return decisions_of(self.guards, sensed)

    def _make_arrived(self, arrivals: Sequence[int]) -> None:
        for robot_id, (before, count) in enumerate(zip(self._arrivals, arrivals, strict=True)):
            if count > before:
                self.guards[robot_id] = self._guard(robot_id, count)
        self._arrivals = arrivals

    def _guard(self, robot_id: int, arrival: int) -> Guard:
        return Guard(robot_id, len(self._setup.robots), partial(make_controller, robot_id, self._setup, arrival))
