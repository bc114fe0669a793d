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
        self._shapes = [team.observation_space(agent).shape or () for agent in agents]
        self.observation_space: Space[Any] = _joined([team.observation_space(agent) for agent in agents])
        self.action_space: Space[Any] = _joined([team.action_space(agent) for agent in agents])

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin a mission, see `TeamEnv.reset`."""
        super().reset(seed=seed)
        vectors, infos = self.team.reset(seed, options)
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
        agents = zip(self.team.possible_agents, self._shapes, strict=True)
        return np.concatenate([vectors.get(agent, np.zeros(shape, np.float32)) for agent, shape in agents])

    def _split(self, action: Any) -> dict[str, Any]:
        """Return the action of each agent. Raises: LearningError: an action of another size."""
        agents, value = self.team.possible_agents, np.asarray(action)
        if value.shape != self.action_space.shape:
            raise LearningError(f"action of shape {value.shape}; expected {self.action_space.shape}")
        if isinstance(self.action_space, MultiDiscrete):
            return dict(zip(agents, value, strict=True))
        ends = np.cumsum([(self.team.action_space(agent).shape or ())[0] for agent in agents])[:-1]
        return dict(zip(agents, np.split(value, ends), strict=True))


def _joined(spaces: list[Space[Any]]) -> Space[Any]:
    """Return the space of several agents, one after the other. Raises: LearningError: neither vectors nor Discrete."""
    numbers = [space.n for space in spaces if isinstance(space, Discrete)]
    if len(numbers) == len(spaces):
        return MultiDiscrete(numbers)
    boxes = [space for space in spaces if isinstance(space, Box) and len(space.shape) == 1]
    if len(boxes) < len(spaces):
        raise LearningError(f"spaces {', '.join(map(str, spaces))}; expected vectors, or Discrete in all")
    low, high = (np.concatenate([getattr(box, end) for box in boxes]) for end in ("low", "high"))
    return Box(low, high, dtype=np.float32)


def register() -> None:
    """Register environments with Gymnasium, for `gymnasium.make`."""
    for name, scenario in (("GarageSearch", "garage_sar"), ("FloorSearch", "isr_floor_0_sar")):
        gymnasium.register(f"robotteamsim/{name}-v0", f"{__name__}:gym_env", kwargs={"scenario": scenario})
