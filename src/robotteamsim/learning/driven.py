"""The stage of the controllers in an environment: robots that obey actions, and all others."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import msgspec

from robotteamsim.control import Guard, make_controller
from robotteamsim.control.runtime.base_station import StandingBase, with_base
from robotteamsim.interface import Controller, Decision, Message, Observation, Task
from robotteamsim.scenario import Scenario
from robotteamsim.setup import Setup
from robotteamsim.simulation.controllers import TeamInputs, decisions_of


def driven_ids(scenario: Scenario) -> list[int]:
    """Return the ids of the robots that obey actions: all but the base and relays."""
    return [i for i in range(scenario.num_robots - scenario.relays.count) if i != scenario.base]


class _Given:
    """Decides what it was given."""

    decision = Decision()

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """As for all controllers."""
        return self.decision


class DrivenControllers:
    """Driven robots decide what they are given; relays, base and people decide as with a controller of a user's class.

    Discoveries are announced to the base in any case.
    """

    def __init__(self, setup: Setup) -> None:
        """Make the controllers. Raises: RobotTeamSimError: the user's mistake."""
        self._given = {i: _Given() for i in driven_ids(setup.scenario)}
        self._controllers = [self._controller(i, setup) for i in range(len(setup.robots))]
        self.faults: Sequence[str] = ("",) * len(setup.robots)

    def _controller(self, robot_id: int, setup: Setup) -> Controller:
        scenario, given = setup.scenario, self._given.get(robot_id)
        if given is None and (robot_id != scenario.base or scenario.firefighters is not None):
            return Guard(robot_id, len(setup.robots), partial(make_controller, robot_id, setup))
        controller = given or StandingBase()
        return controller if scenario.base is None else with_base(controller, robot_id, scenario)

    def give(self, robot_id: int, decision: Decision) -> None:
        """Give a robot its decision for this step; it holds until it gets another, its messages only once."""
        self._given[robot_id].decision = decision

    def step(self, inputs: TeamInputs) -> tuple[Decision, ...]:
        """As for all controllers."""
        decisions = decisions_of(self._controllers, inputs)
        for given in self._given.values():
            given.decision = msgspec.structs.replace(given.decision, outbox=())
        return decisions
