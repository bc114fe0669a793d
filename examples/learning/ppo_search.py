"""Train a team to search with Stable-Baselines3: PPO, every robot an environment of one shared policy."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import search_task
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecEnv

from robotteamsim.learning import BatchEnv


class RobotsVecEnv(VecEnv):
    """Each robot of each mission is an environment; a mission that is over begins again at once."""

    def __init__(self, batch: BatchEnv, seed: int) -> None:
        """Args: seed: of the first mission."""
        self.batch, self.first_seed, self.rewards, self.render_mode = batch, seed, 0.0, None
        super().__init__(batch.num_envs * batch.num_robots, batch.observe.space, batch.act.space)

    def reset(self) -> np.ndarray:
        """Begin all missions."""
        return self.batch.reset(self.first_seed).reshape(self.num_envs, -1)

    def step_async(self, actions: np.ndarray) -> None:
        """Keep the actions."""
        self._actions = actions

    def step_wait(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        """Let all robots act."""
        batch = self.batch
        step = batch.step(self._actions.reshape(batch.num_envs, batch.num_robots, *batch.act.space.shape))
        observations, rewards = step.observations.reshape(self.num_envs, -1), step.rewards.ravel()
        is_over, is_terminated = np.repeat(step.is_over, batch.num_robots), step.terminated.ravel()
        is_done = is_terminated | step.truncated.ravel() | is_over  # also of a robot that left before
        is_cut = is_done & ~is_terminated
        infos: list[dict[str, Any]] = [{} for _ in is_done]
        for i in np.flatnonzero(is_done):
            infos[i] = {"terminal_observation": observations[i], "TimeLimit.truncated": bool(is_cut[i])}
        if step.is_over.any():
            observations = batch.begin(step.is_over).reshape(self.num_envs, -1)
        self.rewards = 0.99 * self.rewards + 0.01 * float(rewards.mean())
        return observations, rewards, is_done, infos

    def close(self) -> None:
        """There is nothing to close."""

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return an attribute, which all environments share."""
        return [getattr(self, attr_name)] * self.num_envs

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Raises: NotImplementedError."""
        raise NotImplementedError

    def env_method(self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any) -> list[Any]:
        """Raises: NotImplementedError."""
        raise NotImplementedError

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        """Return that none is."""
        return [False] * self.num_envs


def main(arguments: Sequence[str] | None = None) -> None:
    """Train, and write the policy."""
    options = search_task.options(__doc__, "out/ppo", arguments)
    torch.set_num_threads(1)
    env = RobotsVecEnv(search_task.training_batch(options.batch), options.seed * 10_000)
    ppo = PPO(
        "MlpPolicy",
        env,
        seed=options.seed,
        device="cpu",
        n_steps=128,
        batch_size=2048,
        n_epochs=6,
        learning_rate=1e-3,
        gamma=0.98,
        ent_coef=0.0,
        target_kl=0.03,
        policy_kwargs={"net_arch": [64, 64], "log_std_init": -0.5},
    )
    greedy = torch.nn.Sequential(ppo.policy.mlp_extractor.policy_net, ppo.policy.action_net, torch.nn.Hardtanh())
    training = search_task.Training("ppo", greedy, options)
    while training.goes_on(ppo.num_timesteps, env.rewards):
        ppo.learn(ppo.n_steps * env.num_envs, reset_num_timesteps=False)


if __name__ == "__main__":
    main()
