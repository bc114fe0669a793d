"""The stage of the controllers in an environment: robots that obey actions, and all others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from robotteamsim.control.runtime.base_station import StandingBase, with_base
from robotteamsim.control.runtime.located import Located
from robotteamsim.control.runtime.registry import make_belief
from robotteamsim.interface import Controller, Decision, Message, Observation, Task
from robotteamsim.learning.errors import LearningError
from robotteamsim.maps.found_map import FoundMap, without_walls
from robotteamsim.mission import Sensed
from robotteamsim.scenario.controllers import Control
from robotteamsim.setup import Setup
from robotteamsim.simulation.controllers import TeamControllers


class _Obeying:
    """Returns the decision that was set for its robot."""

    def __init__(self, commanded: Sequence[Decision], robot_id: int) -> None:
        self._commanded, self._robot_id = commanded, robot_id

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """As for all controllers."""
        return self._commanded[self._robot_id]


class Believed(NamedTuple):
    """What the agents of a mission get in a step in place of the truth, as their controllers would.

    observations: one per agent; None for an absent one.
    inboxes:      one per agent, without the messages by which robots share their maps.
    """

    observations: Sequence[Observation | None]
    inboxes: Sequence[Sequence[Message]]


class _Agent(Located):
    """An obeying robot with the localiser and the map of any other controller: it perceives before it decides."""

    perceived: tuple[Observation, Sequence[Message]]

    def step(self, observation: Observation, inbox: Sequence[Message], task: Task) -> Decision:
        """Return the decision that was set after `perceived`, with the news that are due."""
        return self.decide(*self.perceived, task)


def believes(control: Control) -> bool:
    """Whether agents find their poses by their lasers, so that the truth of a step is not what they perceive."""
    return control.map == "unknown" or control.localisation == "laser"


def known_setup(setup: Setup, found: Mapping[int, FoundMap]) -> Setup:
    """Return what agents know of a mission: without the building, if nobody knows it. Args: found: their maps."""
    is_known = setup.scenario.control.map == "known"
    return setup if is_known else setup.without_building(without_walls(setup.plan), found)


class DrivenControllers(TeamControllers):
    """Driven robots obey the decisions of `command`; relays, base and people have the controllers of any other mission.

    Discoveries are announced to the base in any case. With `control.map: unknown` or `localisation: laser`, agents have
    the localisers and surveys of all controllers: what these say travels over the network, and counts there.
    """

    def __init__(self, setup: Setup) -> None:
        """Make the controllers. Raises: RobotTeamSimError: the user's mistake."""
        self._driven = setup.scenario.searcher_ids
        self._commanded = [Decision() for _ in setup.robots]
        super().__init__(setup)

    @property
    def found(self) -> dict[int, FoundMap]:
        """The maps of the agents by their ids; empty if they know the building."""
        agents = {i: self.guards[i].controller for i in self._driven}
        return {i: one.found for i, one in agents.items() if isinstance(one, _Agent) and one.found is not None}

    def perceive(self, sensed: Sensed) -> Believed | None:
        """Let the agents localise and map in a step, before `step`; None: what was sensed is what they perceive."""
        if not believes(self._setup.scenario.control):
            return None
        observations: list[Observation | None] = []
        inboxes: list[Sequence[Message]] = []
        for i in self._driven:
            agent, observation, inbox = self.guards[i].controller, None, sensed.inboxes[i]
            if sensed.is_there(i):
                assert isinstance(agent, _Agent)
                agent.perceived = observation, inbox = agent.perceive(sensed.observation(i), inbox, sensed.task)
            observations.append(observation)
            inboxes.append(inbox)
        return Believed(observations, inboxes)

    def command(self, decisions: Sequence[Decision]) -> None:
        """Set what the driven robots, in id order, do until the next call; messages are sent once."""
        for i, decision in zip(self._driven, decisions, strict=True):
            self._commanded[i] = decision

    def step(self, sensed: Sensed) -> tuple[Decision, ...]:
        """As for all controllers."""
        decisions = super().step(sensed)
        for i in self._driven:
            if fault := self.guards[i].fault:
                raise LearningError(f"robot_{i}: {fault}")
        self._commanded[:] = [Decision(one.twist) for one in self._commanded]
        return decisions

    def _controller(self, robot_id: int, arrival: int) -> Controller:
        scenario, is_driven = self._setup.scenario, robot_id in self._driven
        if not is_driven and (robot_id != scenario.base or scenario.firefighters is not None):
            return super()._controller(robot_id, arrival)
        controller: Controller = _Obeying(self._commanded, robot_id) if is_driven else StandingBase()
        if scenario.base is not None:
            controller = with_base(controller, robot_id, scenario)
        if not believes(scenario.control):
            return controller
        belief = make_belief(robot_id, self._setup, arrival)
        assert belief.localiser is not None
        kind = _Agent if is_driven else Located
        return kind(lambda setup: controller, robot_id, belief.setup, belief.localiser, belief.survey)
