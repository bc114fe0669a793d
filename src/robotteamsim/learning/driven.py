"""The stage of the controllers in an environment: robots that obey actions, and all others."""

from __future__ import annotations

from collections.abc import Sequence

from robotteamsim.control.runtime.base_station import StandingBase, with_base
from robotteamsim.interface import Controller, Decision, Message, Observation, Task
from robotteamsim.mission import Sensed
from robotteamsim.setup import Setup
from robotteamsim.simulation.controllers import TeamControllers


class _Obeying:
    """Returns the decision that was set for its robot."""

    def __init__(self, commanded: Sequence[Decision], robot_id: int) -> None:
        self._commanded, self._robot_id = commanded, robot_id

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """As for all controllers."""
        return self._commanded[self._robot_id]


class DrivenControllers(TeamControllers):
    """Driven robots obey the decisions of `command`; relays, base and people have the controllers of any other mission.

    Discoveries are announced to the base in any case.
    """

    def __init__(self, setup: Setup) -> None:
        """Make the controllers. Raises: RobotTeamSimError: the user's mistake."""
        self._driven = setup.scenario.searcher_ids
        self._commanded = [Decision() for _ in setup.robots]
        super().__init__(setup)

    def command(self, decisions: Sequence[Decision]) -> None:
        """Set what the driven robots, in id order, do until the next call; messages are sent once."""
        for i, decision in zip(self._driven, decisions, strict=True):
            self._commanded[i] = decision

    def step(self, sensed: Sensed) -> tuple[Decision, ...]:
        """As for all controllers."""
        decisions = super().step(sensed)
        self._commanded[:] = [Decision(one.twist) for one in self._commanded]
        return decisions

    def _controller(self, robot_id: int, arrival: int) -> Controller:
        scenario, is_driven = self._setup.scenario, robot_id in self._driven
        if not is_driven and (robot_id != scenario.base or scenario.firefighters is not None):
            return super()._controller(robot_id, arrival)
        controller = _Obeying(self._commanded, robot_id) if is_driven else StandingBase()
        return controller if scenario.base is None else with_base(controller, robot_id, scenario)
