"""A mission as a Gymnasium `Env`: one agent that drives all robots."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from gymnasium.spaces import Discrete, MultiDiscrete, Space, Tuple
from gymnasium.spaces.utils import flatten, flatten_space, unflatten

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
        self._observations = Tuple(map(team.observation_space, team.possible_agents))
        self._actions = Tuple(map(team.action_space, team.possible_agents))
        numbers = [space.n for space in self._actions if isinstance(space, Discrete)]
        self._are_discrete = len(numbers) == len(self._actions)
        self.observation_space: Space[Any] = flatten_space(self._observations)
        self.action_space: Space[Any] = MultiDiscrete(numbers) if self._are_discrete else flatten_space(self._actions)

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin a mission, see `TeamEnv.reset`."""
        vectors, infos = self.team.reset(seed, options)
        super().reset(seed=None if seed is None else int(seed))
        return self._observation(vectors), {"agents": infos}

    def step(self, action: Any) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Let all robots act. Raises: RobotTeamSimError: see `TeamEnv.step`."""
        parts = self._split(action)
        vectors, rewards, _, truncated, infos = self.team.step({one: parts[one] for one in self.team.agents})
        is_over = not self.team.agents
        was_cut = is_over and any(truncated.values())
        reward = float(np.mean(list(rewards.values())))
        return self._observation(vectors), reward, is_over and not was_cut, was_cut, {"agents": infos}

    def render(self) -> np.ndarray | None:
        """See `TeamEnv.render`."""
        return self.team.render()

    def close(self) -> None:
        """End the mission."""
        self.team.close()

    def _observation(self, vectors: Mapping[str, np.ndarray]) -> np.ndarray:
        agents = zip(self.team.possible_agents, self._observations, strict=True)
        parts = tuple(vectors.get(agent, np.zeros(space.shape or (), space.dtype)) for agent, space in agents)
        return np.asarray(flatten(self._observations, parts))

    def _split(self, action: Any) -> dict[str, Any]:
        """Return the action of each agent. Raises: LearningError: an action of another size."""
        value = np.asarray(action)
        if value.shape != self.action_space.shape:
            raise LearningError(f"action of shape {value.shape}; expected {self.action_space.shape}")
        parts = value if self._are_discrete else unflatten(self._actions, value)
        return dict(zip(self.team.possible_agents, parts, strict=True))
