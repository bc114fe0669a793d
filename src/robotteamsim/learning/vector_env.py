"""A batch of missions as a Gymnasium `VectorEnv`."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector.utils import batch_space

from robotteamsim.learning.batch_env import BatchEnv
from robotteamsim.learning.errors import LearningError
from robotteamsim.learning.gym_env import joint_spaces


class VectorEnv(gymnasium.vector.VectorEnv[np.ndarray, np.ndarray, np.ndarray]):
    """Each mission is an environment whose one agent drives all robots, as `gym_env`; or each robot is one of its own.

    Environments of single robots share one policy. A robot that leaves is terminated, and then has observations of 0
    until its mission begins again; when that mission is over, it is truncated, because what begins again has ended
    before. `info["present"]` has which robots are present, `info["action_mask"]`, with `DiscreteAct`, which actions
    each can choose: shape (num_envs, actions), or (num_envs, robots, actions) if an agent drives all robots.
    """

    def __init__(self, batch: BatchEnv, *, per_robot: bool = False) -> None:
        """Args: per_robot: whether each robot is an environment."""
        self.batch, self._per_robot = batch, per_robot
        self.metadata = {"autoreset_mode": gymnasium.vector.AutoresetMode.NEXT_STEP}
        self.num_envs = batch.num_envs * (batch.num_robots if per_robot else 1)
        self.single_observation_space, self.single_action_space = batch.observe.space, batch.act.space
        if not per_robot:
            self.single_observation_space, self.single_action_space = joint_spaces(
                batch.observe.space, batch.act.space, batch.num_robots
            )
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin all missions, see `BatchEnv.reset`."""
        observations = self.batch.reset(seed)
        super().reset(seed=None if seed is None else int(seed))
        return observations.reshape(self.num_envs, -1), self._info()

    def step(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Let all robots act, see `BatchEnv.step`."""
        batch, was_present = self.batch, self.batch.present
        if np.shape(actions) != self.action_space.shape:
            raise LearningError(f"actions of shape {np.shape(actions)}; expected {self.action_space.shape}")
        step = batch.step(np.reshape(actions, (batch.num_envs, batch.num_robots, *(batch.act.space.shape or ()))))
        absent_ones = step.is_over[:, None] & ~was_present
        rewards, terminated = step.rewards.ravel(), step.terminated.ravel()
        truncated = (step.truncated | absent_ones).ravel()
        if not self._per_robot:
            rewards, truncated = step.rewards.sum(1) / np.maximum(was_present.sum(1), 1), step.truncated.max(1)
            terminated = step.is_over & ~truncated
        return step.observations.reshape(self.num_envs, -1), rewards, terminated, truncated, self._info()

    def _info(self) -> dict[str, Any]:
        info, masks = {"present": self.batch.present.reshape(self.num_envs, -1)}, self.batch.action_mask
        if masks is not None:
            info["action_mask"] = masks.reshape(self.num_envs, *masks.shape[1 + self._per_robot :])
        return info
