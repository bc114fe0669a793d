"""A mission as a Gymnasium `Env`: one agent that drives all robots."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from gymnasium.spaces import Box, Discrete, MultiDiscrete, Space

from robotteamsim.learning.errors import LearningError
from robotteamsim.learning.team_env import TeamEnv, parallel_env
from robotteamsim.scenario import Scenario


def gym_env(scenario: str | os.PathLike[str] | Scenario, **settings: Any) -> CentralEnv:
    """Return a mission as an environment of one agent that drives all robots; for a single robot, its environment.

    Args:   scenario, settings: as of `parallel_env`.
    Raises: RobotTeamSimError: as `parallel_env`.
    """
    return CentralEnv(parallel_env(scenario, **settings))


class CentralEnv(gymnasium.Env[np.ndarray, Any]):
    """Observations and actions of all agents of a `TeamEnv` one after the other; the reward is their mean.

    Of a robot that is not present, the observation is 0 and the action is ignored. `infos["agents"]` has those of each.
    """

    def __init__(self, team: TeamEnv) -> None:
        """Drive the robots of a team."""
        self.team = team
        self.metadata, self.render_mode = team.metadata, team.render_mode
        agents = team.possible_agents
        self._observation, self._action = team.observation_space(agents[0]), team.action_space(agents[0])
        self.observation_space, self.action_space = joint_spaces(self._observation, self._action, len(agents))

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin a mission, see `TeamEnv.reset`."""
        vectors, infos = self.team.reset(seed, options)
        super().reset(seed=None if seed is None else int(seed))
        return self._joint(vectors), {"agents": infos}

    def step(self, action: Any) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Let all robots act. Raises: LearningError: the mission is over. RobotTeamSimError: see `TeamEnv.step`."""
        if not self.team.agents:
            raise LearningError("step: no mission is under way; expected reset first")
        parts = self._split(action)
        vectors, rewards, _, truncated, infos = self.team.step({one: parts[one] for one in self.team.agents})
        is_over = not self.team.agents
        was_cut = is_over and any(truncated.values())
        reward = float(np.mean(list(rewards.values())))
        return self._joint(vectors), reward, is_over and not was_cut, was_cut, {"agents": infos}

    def render(self) -> np.ndarray | None:
        """See `TeamEnv.render`."""
        return self.team.render()

    def close(self) -> None:
        """End the mission."""
        self.team.close()

    def _joint(self, vectors: Mapping[str, np.ndarray]) -> np.ndarray:
        absent = np.zeros(self._observation.shape or (), self._observation.dtype)
        return np.concatenate([vectors.get(agent, absent) for agent in self.team.possible_agents])

    def _split(self, action: Any) -> dict[str, Any]:
        """Return the action of each agent. Raises: LearningError: an action of another size."""
        value = np.asarray(action)
        if value.shape != self.action_space.shape:
            raise LearningError(f"action of shape {value.shape}; expected {self.action_space.shape}")
        agents = self.team.possible_agents
        return dict(zip(agents, value.reshape(len(agents), *(self._action.shape or ())), strict=True))


def joint_spaces(observation: Space[Any], action: Space[Any], num_robots: int) -> tuple[Box, Space[Any]]:
    """Return the spaces of one agent that drives all robots, whose own spaces are equal."""
    assert isinstance(observation, Box)
    if isinstance(action, Discrete):
        return _repeated(observation, num_robots), MultiDiscrete([action.n] * num_robots)
    assert isinstance(action, Box)
    return _repeated(observation, num_robots), _repeated(action, num_robots)


def _repeated(space: Box, times: int) -> Box:
    """Return the space of several values one after the other."""
    low, high = (np.tile(bound.ravel(), times) for bound in (space.low, space.high))
    return Box(low, high, dtype=space.dtype)
