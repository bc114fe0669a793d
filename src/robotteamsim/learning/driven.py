"""The stage of the controllers in an environment: robots that obey actions, and all others."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import msgspec

from robotteamsim.control import Guard, make_controller
from robotteamsim.control.runtime.base_station import with_base
from robotteamsim.interface import Controller, Decision, Message, Observation, Task
from robotteamsim.setup import Setup
from robotteamsim.simulation import TeamInputs


class _Given:
    """Decides what it was given."""

    decision = Decision()

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """As for all controllers."""
        return self.decision


class DrivenControllers:
    """Driven robots decide what they are given; firefighters, command centre and base decide for themselves.

    Discoveries are announced to the base in any case.
    """

    def __init__(self, setup: Setup) -> None:
        """Raises: RobotTeamSimError: the user's mistake, such as a robot that cannot be placed."""
        scenario, robots = setup.scenario, range(len(setup.robots))
        self.driven = [i for i in range(scenario.num_robots) if i != scenario.base]
        """The ids of the robots that obey."""
        self._given = {i: _Given() for i in self.driven}
        controllers: dict[int, Controller] = dict(self._given)
        if scenario.base is not None:
            controllers |= {i: with_base(given, i, scenario) for i, given in self._given.items()}
        controllers |= {
            i: Guard(i, len(robots), partial(make_controller, i, setup)) for i in robots if i not in controllers
        }
        self._controllers = [controllers[i] for i in robots]
        self.faults: Sequence[str] = ("",) * len(robots)

    def give(self, robot_id: int, decision: Decision) -> None:
        """Give a robot its decision for this step; it holds until it gets another, its messages only once."""
        self._given[robot_id].decision = decision

    def step(self, inputs: TeamInputs) -> tuple[Decision, ...]:
        """As for all controllers."""
        team = zip(self._controllers, observations(inputs), inputs.inboxes, inputs.present.tolist(), strict=True)
        decisions = tuple(
            controller.step(observation, inbox, inputs.task) if is_present else Decision()
            for controller, observation, inbox, is_present in team
        )
        for given in self._given.values():
            given.decision = msgspec.structs.replace(given.decision, outbox=())
        return decisions


def observations(inputs: TeamInputs) -> list[Observation]:
    """Return what each member of the team perceives, in id order."""
    team = zip(inputs.readings.robots, inputs.voices, strict=True)
    return [Observation(i, inputs.sim_time_ns, reading, voice) for i, (reading, voice) in enumerate(team)]
