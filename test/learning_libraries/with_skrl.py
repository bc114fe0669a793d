"""skrl: IPPO and MAPPO on SuperSuit's black_death, because skrl needs what each agent observes in each step; PPO."""
# needs: skrl==2.1.1 supersuit==3.11.0 tinyscaler torch

from __future__ import annotations

from typing import Any

import skrl
import supersuit
import torch
from skrl.agents.torch.ppo import PPO, PPO_CFG
from skrl.envs.wrappers.torch import wrap_env
from skrl.memories.torch import RandomMemory
from skrl.models.torch import CategoricalMixin, DeterministicMixin, GaussianMixin, Model
from skrl.multi_agents.torch.ippo import IPPO, IPPO_CFG
from skrl.multi_agents.torch.mappo import MAPPO, MAPPO_CFG
from skrl.trainers.torch import SequentialTrainer, SequentialTrainerCfg
from teams import batch, cases, team

from robotteamsim.learning import VectorEnv

BRIEF = {"rollouts": 16, "learning_epochs": 2, "mini_batches": 2, "time_limit_bootstrap": True}
PER_AGENT = ("learning_rate_scheduler", "observation_preprocessor", "state_preprocessor", "value_preprocessor")


class Continuous(GaussianMixin, Model):
    def __init__(self, **spaces: Any) -> None:
        Model.__init__(self, **spaces, device="cpu")
        GaussianMixin.__init__(self, clip_actions=True, clip_mean_actions=True)  # nothing is clipped by the environment
        self.layers = torch.nn.Linear(self.num_observations, self.num_actions)
        self.log_std = torch.nn.Parameter(torch.zeros(self.num_actions))

    def compute(self, inputs: Any, role: str) -> Any:
        return self.layers(inputs["observations"]), {"log_std": self.log_std}


class Chosen(CategoricalMixin, Model):
    def __init__(self, **spaces: Any) -> None:
        Model.__init__(self, **spaces, device="cpu")
        CategoricalMixin.__init__(self)
        self.layers = torch.nn.Linear(self.num_observations, self.num_actions)

    def compute(self, inputs: Any, role: str) -> Any:
        return self.layers(inputs["observations"]), {}


class Value(DeterministicMixin, Model):
    def __init__(self, of: str, **spaces: Any) -> None:
        Model.__init__(self, **spaces, device="cpu")
        DeterministicMixin.__init__(self)
        self.of = of
        self.layers = torch.nn.Linear(self.num_states if of == "states" else self.num_observations, 1)

    def compute(self, inputs: Any, role: str) -> Any:
        return self.layers(inputs[self.of]), {}


def models(of: str, **spaces: Any) -> dict[str, Model]:
    policy = Continuous if hasattr(spaces["action_space"], "low") else Chosen
    return {"policy": policy(**spaces), "value": Value(of, **spaces)}


def trained(env: Any, agent: Any) -> None:
    options = {"headless": True, "disable_progressbar": True, "close_environment_at_exit": False}
    SequentialTrainer(env=env, agents=agent, cfg=SequentialTrainerCfg(timesteps=48, **options)).train()
    SequentialTrainer(env=env, agents=agent, cfg=SequentialTrainerCfg(timesteps=16, **options)).eval()


def quiet(config: Any) -> Any:
    config.experiment.write_interval = config.experiment.checkpoint_interval = 0
    return config


def of_agents(kind: Any, config: Any, of: str, env: Any) -> None:
    env = wrap_env(env, wrapper="pettingzoo")
    names = env.possible_agents
    spaces = {"observation_spaces": env.observation_spaces, "action_spaces": env.action_spaces}
    spaces["state_spaces"] = env.state_spaces
    agent = kind(
        possible_agents=names,
        models={name: models(of, **{key[:-1]: value[name] for key, value in spaces.items()}) for name in names},
        memories={name: RandomMemory(memory_size=16, num_envs=1, device="cpu") for name in names},
        cfg=quiet(config(**BRIEF, **{f"{key}_kwargs": {name: {} for name in names} for key in PER_AGENT})),
        device="cpu",
        **spaces,
    )
    trained(env, agent)


def of_rows(env: VectorEnv) -> None:
    env = wrap_env(env, wrapper="gymnasium")
    spaces = {"observation_space": env.observation_space, "action_space": env.action_space}
    memory = RandomMemory(memory_size=16, num_envs=env.num_envs, device="cpu")
    cfg = quiet(PPO_CFG(**BRIEF))
    trained(env, PPO(models=models("observations", **spaces), memory=memory, cfg=cfg, device="cpu", **spaces))


def main() -> None:
    for case, act in cases():
        of_agents(IPPO, IPPO_CFG, "observations", supersuit.black_death_v3(team(case, act)))
        of_agents(MAPPO, MAPPO_CFG, "states", supersuit.black_death_v3(team(case, act)))
        of_rows(VectorEnv(batch(case, act), per_robot=True))
        print(f"{case}, {act.__name__}: IPPO, MAPPO with black_death; PPO of VectorEnv(per_robot=True)")


if __name__ == "__main__":
    print(f"skrl {skrl.__version__}")
    main()
