"""A mission as a PettingZoo `ParallelEnv`."""

from __future__ import annotations

import copy
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from gymnasium.spaces import Box, Space
from pettingzoo import AECEnv, ParallelEnv
from pettingzoo.utils import parallel_to_aec

from robotteamsim.learning.act import Commands
from robotteamsim.learning.errors import LearningError
from robotteamsim.learning.missions import Missions
from robotteamsim.learning.observe import Part
from robotteamsim.learning.rules import AnyScenario, Rules
from robotteamsim.learning.window import Window
from robotteamsim.simulation import StepRecord

Agent = str
Vectors = dict[Agent, np.ndarray]
Infos = dict[Agent, dict[str, Any]]

RENDER_MODES = ["human", "rgb_array"]


def parallel_env(scenario: AnyScenario, *, render_mode: str | None = None, **rules: Any) -> TeamEnv:
    """Return a mission as an environment of many agents, `robot_0` and so on.

    Args:   scenario: a file, a shipped name, or a scenario; its own controllers are not used.
            render_mode: None, rgb_array, or human: the browser viewer, whose address is printed.
            observe, act, reward: what agents perceive, decide and are rewarded for; derive from `Observe`, `Act` and
                `Reward` to change it.
            every: an agent decides in each so many steps of the simulation (`run.step_s`, 0.1 s), and holds its command
                in between; 5 unless given.
            said: how many numbers each message to the other robots has; 0 unless given.
            max_cycles: all agents are truncated after so many of their steps; None: only at the mission's time limit.
            teammates: how many teammates an observation has room for; None: as many as there are.
    Raises: RobotTeamSimError: one line: the scenario is invalid, or has no robot that can be driven.
    """
    if render_mode not in (None, *RENDER_MODES):
        raise LearningError(f"render_mode: {render_mode!r}; expected None, 'human' or 'rgb_array'")
    return TeamEnv(Missions(scenario, Rules.of(rules)), render_mode)


def env(scenario: AnyScenario, **settings: Any) -> AECEnv[Agent, np.ndarray, Any]:
    """Return the environment of `parallel_env` in PettingZoo's other form, in which agents act one after the other."""
    return parallel_to_aec(parallel_env(scenario, **settings))


class TeamEnv(ParallelEnv[Agent, np.ndarray, Any]):  # type: ignore[misc]  # PettingZoo has no types
    """A mission as PettingZoo knows it.

    An agent is terminated when the mission has ended or it is no longer present, and truncated at the time limit.
    Before `reset` and after `close`, the environment can be pickled and copied: libraries make several of one.
    """

    def __init__(self, missions: Missions, render_mode: str | None) -> None:
        """See `parallel_env`."""
        scenario = missions.scenario
        self.metadata = {"name": f"{scenario.name}_v0", "render_modes": RENDER_MODES, "is_parallelizable": True}
        self.metadata["render_fps"] = max(round(1.0 / (missions.rules.every * scenario.run.step_s)), 1)
        self.render_mode = render_mode
        self._missions = missions
        self._window = Window(scenario.name) if render_mode == "human" else None
        if self._window is not None:
            missions.watch = self._window.note
        self.possible_agents = [f"robot_{i}" for i in missions.robot_ids]
        self.agents: list[Agent] = []
        self.observation_spaces = {agent: copy.deepcopy(missions.observe.space) for agent in self.possible_agents}
        self.action_spaces = {agent: copy.deepcopy(missions.act.space) for agent in self.possible_agents}

    @property
    def record(self) -> StepRecord | None:
        """The last record of the simulation, for own measures; None before the first step, and after `close`."""
        return self._missions.record(0)

    @property
    def parts(self) -> tuple[Part, ...]:
        """The parts of observations."""
        return self._missions.observe.parts

    def observation_space(self, agent: Agent) -> Space[Any]:
        """Return the space of an agent's observations; `parts` describes it."""
        return self.observation_spaces[self._known(agent)]

    def action_space(self, agent: Agent) -> Space[Any]:
        """Return the space of an agent's actions."""
        return self.action_spaces[self._known(agent)]

    @property
    def state_space(self) -> Box:
        """The space of `state`."""
        return Box(-1.0, 1.0, (self._missions.state_size,), np.float32)

    def state(self) -> np.ndarray:
        """Return the state of the mission for central critics, see `Missions.state`."""
        return self._missions.state(0)

    def reset(self, seed: int | None = None, options: Mapping[str, Any] | None = None) -> tuple[Vectors, Infos]:
        """Begin a mission, see `Missions.begin`."""
        self.agents = []
        self._missions.begin(0, seed)
        self.agents = self._present()
        return self._vectors(), self._infos()

    def step(
        self, actions: Mapping[Agent, Any]
    ) -> tuple[Vectors, dict[Agent, float], dict[Agent, bool], dict[Agent, bool], Infos]:
        """Let all agents act, and return observations, rewards, terminations, truncations and infos of each.

        Actions of agents that are no longer present are ignored, and after the end all five are empty: libraries step
        once more, or go on to send what an agent that left would do.

        Raises: RobotTeamSimError: one line: the mission has not begun, an agent without an action, or an action that is
                not of its space.
        """
        missions, acting = self._missions, self.agents
        missions.check_begun(0)
        if not isinstance(actions, Mapping):
            raise LearningError(f"actions: {actions!r:.60}; expected an action by the name of each agent")
        if set(actions) - (set(self.possible_agents) - set(acting)) != set(acting):
            given, expected = (", ".join(sorted(map(str, agents))) or "nobody" for agents in (actions, acting))
            raise LearningError(f"actions of {given}; expected {expected}")
        if not acting:
            return {}, {}, {}, {}, {}
        rest = missions.act.rest
        chosen = [actions[agent] if agent in acting else rest for agent in self.possible_agents]
        commands = missions.act.commands(chosen)
        outcome = missions.step(np.array([0]), Commands(commands.twists[None], commands.say[None]))
        if self._window is not None:
            self._window.publish()
        rewards, terminated, truncated = (
            {agent: value for agent, value in self._by_agent(values[0].tolist()) if agent in acting}
            for values in (outcome.rewards, outcome.terminated, outcome.truncated)
        )
        vectors, infos = self._vectors(), self._infos()
        self.agents = [] if outcome.is_over[0] else self._present()
        return vectors, rewards, terminated, truncated, infos

    def render(self) -> np.ndarray | None:
        """Return the mission as a picture, uint8, shape (rows, columns, 3); None with another render mode."""
        if self.render_mode != "rgb_array":
            return None
        from robotteamsim.learning.picture import picture  # late, because only pictures need Matplotlib

        setup = self._missions.setup(0)
        assert self.record is not None
        return picture(setup, self.record)

    def close(self) -> None:
        """End the mission, and its page in the browser."""
        self._missions.end()
        self.agents = []
        if self._window is not None:
            self._window.close()

    def _by_agent(self, values: Iterable[Any]) -> Iterable[tuple[Agent, Any]]:
        return zip(self.possible_agents, values, strict=True)

    def _present(self) -> list[Agent]:
        return [agent for agent, is_present in self._by_agent(self._missions.present[0].tolist()) if is_present]

    def _vectors(self) -> Vectors:
        return {agent: vector for agent, vector in self._by_agent(self._missions.vectors()[0]) if agent in self.agents}

    def _infos(self) -> Infos:
        return {agent: info for agent, info in self._by_agent(self._missions.act.infos()) if agent in self.agents}

    def _known(self, agent: Agent) -> Agent:
        """Return an agent. Raises: LearningError: there is no such agent."""
        if not isinstance(agent, str) or agent not in self.action_spaces:
            raise LearningError(f"there is no agent {agent!r:.60}; expected one of {', '.join(self.possible_agents)}")
        return agent
