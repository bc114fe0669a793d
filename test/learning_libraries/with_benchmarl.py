"""BenchMARL: a task of `TorchRLEnv`; MAPPO with continuous, QMIX with discrete actions and their masks."""
# needs: benchmarl==1.5.2 torchrl==0.11.1 torch

from __future__ import annotations

import tempfile
from collections.abc import Callable
from importlib.metadata import version
from typing import Any

from benchmarl.algorithms import MappoConfig, QmixConfig
from benchmarl.environments import TaskClass
from benchmarl.experiment import Experiment, ExperimentConfig
from benchmarl.models import MlpConfig
from teams import CASES, Act, DiscreteAct, batch, cases
from torchrl.data import Composite
from torchrl.envs import EnvBase

from robotteamsim.learning.torchrl_env import TorchRLEnv


class Team(TaskClass):
    """A team, of which a robot leaves; `config["case"]` says when."""

    def get_env_fun(
        self, num_envs: int, continuous_actions: bool, seed: int | None, device: Any
    ) -> Callable[[], EnvBase]:
        act = Act if continuous_actions else DiscreteAct
        return lambda: TorchRLEnv(batch(self.config["case"], act))

    def supports_continuous_actions(self) -> bool:
        return True

    def supports_discrete_actions(self) -> bool:
        return True

    def max_steps(self, env: EnvBase) -> int:
        return CASES[self.config["case"]][1]

    def has_render(self, env: EnvBase) -> bool:
        return False

    def group_map(self, env: EnvBase) -> dict[str, list[str]]:
        return env.group_map

    def _part(self, env: EnvBase, name: str) -> Composite:
        part = env.full_observation_spec_unbatched.clone()
        for key in set(part["agents"].keys()) - {name}:
            del part["agents"][key]
        return part

    def observation_spec(self, env: EnvBase) -> Composite:
        return self._part(env, "observation")

    def action_mask_spec(self, env: EnvBase) -> Composite | None:
        part = self._part(env, "action_mask")
        return None if part["agents"].is_empty() else part

    def action_spec(self, env: EnvBase) -> Composite:
        return env.full_action_spec_unbatched

    def info_spec(self, env: EnvBase) -> None:
        return None

    def state_spec(self, env: EnvBase) -> None:
        return None

    @staticmethod
    def env_name() -> str:
        return "robotteamsim"


def main() -> None:
    small = MlpConfig.get_from_yaml()
    small.num_cells = [16]
    for case, act in cases():
        config = ExperimentConfig.get_from_yaml()
        config.prefer_continuous_actions = act is Act
        config.max_n_iters, config.max_n_frames = 2, None
        for kind in ("on_policy", "off_policy"):
            setattr(config, f"{kind}_collected_frames_per_batch", 48)
            setattr(config, f"{kind}_n_envs_per_worker", 2)
        config.on_policy_n_minibatch_iters, config.on_policy_minibatch_size = 1, 24
        config.off_policy_n_optimizer_steps, config.off_policy_train_batch_size = 2, 12
        config.off_policy_memory_size = 1000
        config.evaluation, config.evaluation_interval, config.evaluation_episodes = True, 48, 2
        config.render, config.loggers, config.create_json = False, [], False
        with tempfile.TemporaryDirectory() as folder:
            config.save_folder = folder
            kind = (MappoConfig if act is Act else QmixConfig).get_from_yaml()
            parts = {"model_config": small, "critic_model_config": small, "config": config, "seed": 1}
            experiment = Experiment(Team("team", {"case": case}), kind, **parts)
            experiment.run()
        assert experiment.total_frames == 96
        print(f"{case}, {act.__name__}: {kind.__class__.__name__}, {experiment.total_frames} steps")


if __name__ == "__main__":
    print(f"benchmarl {version('benchmarl')}, torchrl {version('torchrl')}")
    main()
